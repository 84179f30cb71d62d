// The schema is JSON, knows every key, and accepts exactly the maps that the reader accepts where keys are concerned.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "common/scene/reader.h"

namespace ballast {
namespace {

using nlohmann::json;

void collect(const json& node, std::set<std::string>& keys) {
  if (!node.is_structured()) return;
  if (node.is_object() && node.contains("properties") && node["properties"].is_object()) {
    for (const auto& [key, value] : node["properties"].items()) keys.insert(key);
  }
  for (const auto& child : node) collect(child, keys);
}

// Written by hand from the description of the format, not from the lists in the code.
const char* const kKeys[] = {"ballast",
                             "description",
                             "world",
                             "fluids",
                             "models",
                             "joints",
                             "coupling",
                             "numerics",
                             "probes",
                             "output",
                             "expect",
                             "gravity",
                             "dimension",
                             "duration",
                             "spacing",
                             "accuracy",
                             "periodic",
                             "domain",
                             "allow_overlap",
                             "seed",
                             "sleep",
                             "after",
                             "attraction",
                             "rate",
                             "centre",
                             "min",
                             "max",
                             "name",
                             "material",
                             "density",
                             "viscosity",
                             "surface_tension",
                             "velocity",
                             "angular_velocity",
                             "vortices",
                             "speed",
                             "wavelength",
                             "strain",
                             "fill",
                             "box",
                             "mesh",
                             "level",
                             "container",
                             "z",
                             "file",
                             "scale",
                             "position",
                             "rotation",
                             "static",
                             "prescribed",
                             "shape",
                             "pose",
                             "mass",
                             "friction",
                             "restitution",
                             "repeat",
                             "count",
                             "step",
                             "sphere",
                             "cylinder",
                             "capsule",
                             "plane",
                             "open_box",
                             "inside",
                             "wall",
                             "lid",
                             "hollow_sphere",
                             "hollow_cylinder",
                             "compound",
                             "radius",
                             "length",
                             "normal",
                             "amplitude",
                             "frequency",
                             "phase",
                             "start",
                             "stop",
                             "type",
                             "parent",
                             "child",
                             "anchor",
                             "axis",
                             "axis2",
                             "limits",
                             "lower",
                             "upper",
                             "motor",
                             "max_effort",
                             "spring",
                             "damper",
                             "rest",
                             "engine",
                             "scheme",
                             "tolerance",
                             "most_iterations",
                             "substeps",
                             "rigid_step",
                             "contact_sets",
                             "pressure",
                             "kernel",
                             "support",
                             "sound_speed",
                             "courant",
                             "diffusion",
                             "shifting",
                             "artificial_viscosity",
                             "reduced_gravity",
                             "relax",
                             "skip_search",
                             "energy_bound",
                             "level_at",
                             "pressure_at",
                             "velocity_at",
                             "force_on",
                             "pose_of",
                             "pressure_error",
                             "motion_of",
                             "void_in",
                             "moves_with",
                             "every",
                             "vtk",
                             "picture",
                             "camera",
                             "lcm",
                             "checkpoint",
                             "keep",
                             "lcm_particles",
                             "lost_particles",
                             "moved",
                             "at_least",
                             "by",
                             "column",
                             "of",
                             "statistic",
                             "from",
                             "to",
                             "equals",
                             "within",
                             "below",
                             "above",
                             "initial_acceleration",
                             "model",
                             "coefficient",
                             "fluid",
                             "jitter",
                             "momentum",
                             "total_momentum",
                             "track",
                             "reference",
                             "time_offset",
                             "value_offset"};

TEST(Schema, IsJsonAndHoldsExactlyTheKeysOfTheFormat) {
  const json schema = json::parse(scene_schema());
  std::set<std::string> keys;
  collect(schema, keys);
  EXPECT_EQ(keys, std::set<std::string>(std::begin(kKeys), std::end(kKeys)));
}

TEST(Schema, RefersOnlyToWhatItDefines) {
  const json schema = json::parse(scene_schema());
  std::vector<const json*> open{&schema};
  int references = 0;
  while (!open.empty()) {
    const json& node = *open.back();
    open.pop_back();
    if (node.is_object() && node.contains("$ref")) {
      const std::string name = node["$ref"].get<std::string>().substr(std::string("#/$defs/").size());
      EXPECT_TRUE(schema["$defs"].contains(name)) << name;
      ++references;
    }
    if (node.is_structured()) {
      for (const auto& child : node) open.push_back(&child);
    }
  }
  EXPECT_GT(references, 10);
}

TEST(Schema, SaysUnitsBoundsWordsAndWhatIsRequired) {
  const json schema = json::parse(scene_schema());
  EXPECT_EQ(schema["required"], json({"ballast"}));
  EXPECT_EQ(schema["additionalProperties"], false);
  const json& definitions = schema["$defs"];
  EXPECT_THAT(definitions["fluids_item"]["properties"]["density"]["description"].get<std::string>(),
              ::testing::HasSubstr("[kg/m^3]"));
  EXPECT_EQ(definitions["world"]["properties"]["duration"]["anyOf"][0]["exclusiveMinimum"], 0);
  EXPECT_EQ(definitions["coupling"]["properties"]["engine"]["enum"], json({"ode", "free_body"}));
  EXPECT_EQ(definitions["coupling"]["properties"]["scheme"]["default"], "auto");
  EXPECT_EQ(definitions["shape"]["oneOf"].size(), 10u);
  EXPECT_FALSE(definitions["fluids_item"]["properties"]["density"].contains("default"));
}

TEST(Help, HasOneLineForEveryKey) {
  const std::string help = scene_help();
  for (const char* key : kKeys) {
    EXPECT_THAT(help, ::testing::ContainsRegex("(^|\n) *" + std::string(key) + " ")) << key;
  }
}

}  // namespace
}  // namespace ballast
