// Broken scenes: each is refused at its line and column, with the reason and a cure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/scene/reader.h"

namespace ballast {
namespace {

using ::testing::HasSubstr;

// Good as it stands; the table below breaks one thing at a time.
const std::string kGood = R"(ballast: 1
world:
  spacing: 2 cm
  dimension: 3
  gravity: [0, 0, -9.81]
fluids:
  - name: water
    material: water
    fill: { box: { min: [0, 0, 0], max: [1, 1, 1] } }
models:
  - name: tank
    static: true
    shape: { open_box: { inside: [1, 1, 2] } }
  - name: disc
    shape: { cylinder: { radius: 0.1, length: 0.05 } }
    density: 500
    friction: 0.3
    pose: [0, 0, 0]
  - name: rod
    shape: { box: [1, 1, 1] }
    mass: 2 kg
joints:
  - name: hinge
    type: revolute
    parent: rod
    child: disc
    axis: [0, 1, 0]
probes:
  - { name: front, level_at: [0, 0] }
  - { name: push, force_on: tank }
output:
  every: 20 ms
expect:
  - { column: { of: push.fz, below: 3 } }
  - { moved: { models: "d*", at_least: 1, by: 1 } }
)";

struct Case {
  std::string from, to;           // what to replace in kGood, and by what
  std::string where, what, cure;  // "line:column" or "" for the whole file; parts of the message
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.from << " -> " << c.to; }

class Broken : public ::testing::TestWithParam<Case> {};

TEST_P(Broken, IsRefusedWhereItIsBroken) {
  const Case& c = GetParam();
  std::string text = kGood;
  ASSERT_NE(text.find(c.from), std::string::npos);
  text.replace(text.find(c.from), c.from.size(), c.to);
  const auto scene = read_scene_text(text, "s.yaml");
  ASSERT_FALSE(scene) << "accepted";
  const Error& error = scene.error();
  EXPECT_EQ(error.where, c.where.empty() ? "s.yaml" : "s.yaml:" + c.where) << error.text();
  EXPECT_THAT(error.what, HasSubstr(c.what));
  EXPECT_THAT(error.cure, HasSubstr(c.cure));
  EXPECT_FALSE(error.cure.empty());
  EXPECT_EQ(error.exit_code, kBadInput);
}

TEST(Scenes, TheUnbrokenOneIsAccepted) {
  const auto scene = read_scene_text(kGood, "s.yaml");
  ASSERT_TRUE(scene) << scene.error().text();
}

INSTANTIATE_TEST_SUITE_P(
    Syntax, Broken,
    ::testing::Values(Case{"[0, 0, -9.81]", "[0, 0, -9.81", "6:7", "YAML syntax", "brackets"},
                      Case{"  gravity", " gravity", "5:2", "YAML syntax", "indentation"},
                      Case{kGood, "", "", "empty", "ballast: 1"},
                      Case{kGood, "# only words\n", "", "empty", "ballast: 1"},
                      Case{kGood, "- 1\n", "1:1", "a scene is a map", "ballast: 1"},
                      Case{kGood, "ballast: 1\n---\nballast: 1\n", "3:1", "second document", "---"},
                      Case{kGood, "a: &a [*a]\n", "1:4", "without end", "alias"},
                      Case{"  every: 20 ms", "  every: 20 ms\n  every: 30 ms", "33:3",
                           "'every' appears twice, first at s.yaml:32:3", "Remove"},
                      Case{"  every: 20 ms", "  [1, 2]: 20 ms", "32:3", "a key is not plain text", "word"}));

INSTANTIATE_TEST_SUITE_P(
    Keys, Broken,
    ::testing::Values(
        Case{"    density: 500", "    densty: 500", "16:5", "'densty' is not known", "Did you mean 'density'?"},
        Case{"models:", "modles:", "10:1", "'modles' is not known", "Did you mean 'models'?"},
        Case{"radius: 0.1", "raduis: 0.1", "15:26", "'raduis'", "'radius'"},
        Case{"cylinder:", "cilinder:", "15:14", "'cilinder'", "'cylinder'"},
        Case{"level_at", "levle_at", "29:20", "'levle_at'", "'level_at'"},
        Case{"moved:", "quatsch:", "35:7", "'quatsch'", "Known here: lost_particles"},
        Case{"ballast: 1\n", "", "1:1", "'ballast' is missing", "Add ballast"},
        Case{"ballast: 1", "ballast: 2", "1:10", "out of range", "Use a value 1."},
        Case{"  - name: rod\n    shape", "  - shape", "19:5", "'name' is missing", "Add name"},
        Case{"    shape: { box: [1, 1, 1] }\n", "", "19:5", "'shape' is missing", "Add shape"},
        Case{", length: 0.05", "", "15:24", "'length' is missing", "whole length"},
        Case{"{ cylinder: { radius: 0.1, length: 0.05 } }", "{}", "15:12", "nothing here says what the shape is",
             "box, sphere"},
        Case{"{ box: [1, 1, 1] }", "{ box: [1, 1, 1], sphere: { radius: 1 } }", "20:30",
             "box and sphere exclude each other", "s.yaml:20:14"},
        Case{"    density: 500", "    density: 500\n    mass: 1", "17:5", "density and mass exclude each other",
             "s.yaml:16:5"},
        Case{"    static: true", "    static: true\n    density: 5", "13:5", "density has no effect", "Remove density"},
        Case{"    axis: [0, 1, 0]", "    axis2: [0, 1, 0]", "27:5", "only for universal joints", "Remove axis2"},
        Case{"type: revolute", "type: ball", "27:5", "axis has no effect", "Remove axis"}));

INSTANTIATE_TEST_SUITE_P(
    Values, Broken,
    ::testing::Values(
        Case{"2 cm", "2 kg", "3:12", "spacing: '2 kg' is a mass (kg), but a length (m) is needed", "Write it in m"},
        Case{"2 cm", "-2 cm", "3:12", "spacing is -2 cm, which is out of range", "at least 0 m"},
        Case{"2 cm", "2 spacings", "3:12", "needs world.spacing", "metres"},
        Case{"2 cm", "", "3:3", "spacing has no value", "Give it"},
        Case{"2 cm", "{}", "3:12", "spacing is a map, but a number is needed", "Write"},
        Case{"-9.81]", "nan]", "5:19", "not a finite number", "finite"},
        Case{"-9.81]", ".inf]", "5:19", "'.inf' is not a number", "acceleration"},
        Case{"0, 0, -9.81", "0, -9.81", "5:12", "gravity has 2 values, but 3 are needed", "[1, 1, 1]"},
        Case{"dimension: 3", "dimension: 4", "4:14", "out of range", "from 2 to 3"},
        Case{"dimension: 3", "dimension: 2.5", "4:14", "not a whole number", "whole number"},
        Case{"dimension: 3", "seed: -1", "4:9", "2^64", "seed: 1"},
        Case{"dimension: 3", "accuracy: balance", "4:13", "'balance' is not known", "Did you mean 'balanced'?"},
        Case{"dimension: 3", "allow_overlap: yes", "4:18", "'yes' is not known", "true, false"},
        Case{"dimension: 3", "periodic: x", "4:13", "periodic is a plain value, but a list is needed", "["},
        Case{"dimension: 3", "periodic: [x, x]", "4:17", "names the axis x twice", "Remove"},
        Case{"dimension: 3", "duration: 0", "4:13", "out of range", "greater than 0 s"},
        Case{"mass: 2 kg", "mass: -2 kg", "21:11", "mass is -2 kg", "greater than 0 kg"},
        Case{"mass: 2 kg", "mass: 0", "21:11", "mass is 0", "greater than 0 kg"},
        Case{"material: water", "material: watre", "8:15", "'watre' is not known", "Did you mean 'water'?"},
        Case{"name: disc", "name: di.sc", "14:11", "'di.sc' is not a name", "letters"},
        Case{"static: true", "static: 1", "12:13", "'1' is not known", "true, false"},
        Case{"box: [1, 1, 1]", "box: [1, 0, 1]", "20:23", "box is 0", "greater than 0 m"},
        Case{"box: [1, 1, 1]", "mesh: { file: none.obj }", "20:28", "there is no file", "relative to the scene"},
        Case{"pose: [0, 0, 0]", "pose: [0, 0]", "18:11", "pose has 2 values, but 3 or 6", "rotation"},
        Case{"pose: [0, 0, 0]", "pose: [0, 0, 0, 1 m, 0, 0]", "18:21", "'1 m' is a length (m), but an angle", "rad"},
        Case{"pose: [0, 0, 0]", "pose: { rotation: [2, 0, 0, 0] }", "18:23", "length 2, not 1", "unit quaternion"},
        Case{"axis: [0, 1, 0]", "axis: [0, 0, 0]", "27:11", "axis has no direction", "unit vector"},
        Case{"axis: [0, 1, 0]", "axis: [0, 3, 4]", "27:11", "axis has the length 5", "[0, 0.6, 0.8]"},
        Case{"output:", "coupling: { engine: od }\noutput:", "31:21", "'od' is not known", "Did you mean 'ode'?"},
        Case{"output:", "coupling: { scheme: iterate }\noutput:", "31:21", "'iterate' is not known",
             "Did you mean 'iterated'?"},
        Case{"output:", "coupling: { scheme: staggered, tolerance: 1 % }\noutput:", "31:32",
             "only for the iterated scheme", "Remove tolerance"},
        Case{"output:", "numerics: { pressure: implicit, courant: 0.2 }\noutput:", "31:33",
             "only for the explicit solver", "Remove courant"},
        Case{"output:", "numerics: { pressure: implicit, diffusion: 0.2 }\noutput:", "31:33",
             "only for the explicit solver", "Remove diffusion"},
        Case{"output:", "numerics: { pressure: implicit }\ncoupling: { scheme: staggered }\noutput:", "32:21",
             "knows no staggered", "numerics.pressure: wcsph"},
        Case{"models:\n", "models: 3\nx:\n", "11:1", "'x' is not known", "Known here"},
        Case{kGood, "{ballast: 1, models: 3}", "1:22", "models is a plain value, but a list is needed", "-"},
        Case{kGood, "{ballast: 1, models: [3]}", "1:23", "models is a plain value, but a map is needed",
             "key: value"}));

INSTANTIATE_TEST_SUITE_P(Frames, Broken,
                         ::testing::Values(Case{"level_at: [0, 0]", "level_at: [0, 0], moves_with: tan", "29:50",
                                                "no model 'tan'", "'tank'"},
                                           Case{"level_at: [0, 0]", "level_at: [0, 0], moves_with: disc", "29:50",
                                                "'disc' moves freely", "static or prescribed"},
                                           Case{"force_on: tank", "force_on: tank, moves_with: tank", "30:35",
                                                "probes at a place", "Remove moves_with"}));

INSTANTIATE_TEST_SUITE_P(
    Support, Broken,
    ::testing::Values(Case{"world:", "numerics: { support: 1.5 }\nworld:", "2:22", "within 1.5 spacings", "Set 2 to 6"},
                      Case{"world:", "numerics: { support: 7 }\nworld:", "2:22", "is 7", "from 0 to 6"}));

INSTANTIATE_TEST_SUITE_P(Attraction, Broken,
                         ::testing::Values(Case{"world:", "world:\n  attraction: { rate: 1 Hz }", "12:5",
                                                "would not act on the model 'tank'", "Remove"},
                                           Case{"world:", "world:\n  attraction: { centre: [1, 0, 0] }", "3:25",
                                                "without a rate", "1/s"}));

INSTANTIATE_TEST_SUITE_P(
    References, Broken,
    ::testing::Values(
        Case{"child: disc", "child: dics", "26:12", "child 'dics' is not a model", "Did you mean 'disc'?"},
        Case{"parent: rod", "parent: wold", "25:13", "neither a model nor 'world'", "Did you mean 'world'?"},
        Case{"parent: rod", "parent: disc", "26:12", "connects 'disc' with itself", "different"},
        Case{"force_on: tank", "force_on: tan", "30:29", "no model 'tan'", "'tank'"},
        Case{"level_at: [0, 0]", "pressure_error: wate", "29:36", "no fluid 'wate'", "'water'"},
        Case{"level_at: [0, 0]", "motion_of: wate", "29:31", "no fluid 'wate'", "'water'"},
        Case{"level_at: [0, 0]", "void_in: wate", "29:29", "no fluid 'wate'", "'water'"},
        Case{"push.fz", "push.fq", "34:21", "no column 'push.fq'", "push.f"},
        Case{"force_on: tank", "velocity_at: [0, 0, 0]", "34:21", "no column 'push.fz'", "push.vz"},
        Case{"push.fz", "tank.x", "34:21", "'tank' is static", "force_on"},
        Case{"push.fz", "push", "34:21", "no column 'push'", "push.fx"},
        Case{"push.fz, below: 3", "push.fz, below: 3 m", "34:37", "is a length (m), but a force (N)", "N"},
        Case{"push.fz, below: 3", "push.fz", "34:15", "not compared", "below"},
        Case{"push.fz, below: 3", "push.fz, equals: 3", "34:15", "no tolerance", "within"},
        Case{"push.fz, below: 3", "push.fz, equals: 0, within: 3 %", "34:49", "allows nothing", "absolute"},
        Case{"push.fz, below: 3", "push.fz, below: 3, above: 4", "34:15", "nothing is above 4", "less"},
        Case{"push.fz, below: 3", "push.fz, below: 3, from: 4, to: 2", "34:5", "no sample lies", "from"},
        Case{"\"d*\"", "\"q*\"", "35:24", "no model matches 'q*'", "Known here"},
        Case{"\"d*\"", "tank", "35:24", "only static models", "can move"},
        Case{"at_least: 1", "at_least: 2", "35:40", "names only 1", "at most 1"},
        Case{"{ moved: { models: \"d*\", at_least: 1, by: 1 } }", "{ inside: { models: disc, container: rod } }",
             "35:42", "'rod' has no inside", "open_box"},
        Case{"{ moved: { models: \"d*\", at_least: 1, by: 1 } }", "{ lost_particles: 3 }", "35:23",
             "neither 0 nor a share", "5 %"},
        Case{"{ box: { min: [0, 0, 0], max: [1, 1, 1] } }", "{ level: { container: tnak, z: 1 } }", "9:33",
             "'tnak' is not a model", "'tank'"},
        Case{"{ box: { min: [0, 0, 0], max: [1, 1, 1] } }", "{ level: { container: rod, z: 1 } }", "9:33", "no inside",
             "open_box"}));

INSTANTIATE_TEST_SUITE_P(
    Contradictions, Broken,
    ::testing::Values(
        Case{"name: rod", "name: disc", "19:11", "'disc' exists already, at s.yaml:14:5", "name of its own"},
        Case{"name: push", "name: front", "30:13", "a probe named 'front' exists already", "name of its own"},
        Case{"name: rod", "name: world", "19:11", "'world' is the name of the fixed frame", "another"},
        Case{"    mass: 2 kg\n", "", "19:5", "'rod' has neither density nor mass", "static: true"},
        Case{"    material: water\n", "", "7:5", "neither material nor density", "material: water"},
        Case{"  spacing: 2 cm\n", "", "3:3", "needs a particle spacing", "world.spacing"},
        Case{"max: [1, 1, 1]", "max: [1, 0, 1]", "9:18", "empty along y", "min be below max"},
        Case{"dimension: 3", "periodic: [x]", "4:13", "need a domain", "world.domain"},
        Case{"dimension: 3", "domain: { min: [0, 0, 0], max: [1, 1, 0] }", "4:11", "empty along z", "below max"},
        Case{"axis: [0, 1, 0]", "axis: [0, 1, 0]\n    limits: { lower: 2, upper: 1 }", "28:13", "lower limit 2",
             "below upper"},
        Case{"axis: [0, 1, 0]", "axis: [0, 1, 0]\n    motor: { velocity: 2 }", "28:12", "max_effort", "Add max_effort"},
        Case{"type: revolute", "type: universal\n    axis2: [0, 1, 0]", "25:12", "right angles", "orthogonal"},
        Case{"mass: 2 kg", "prescribed: { start: 3, stop: 2 }", "21:35", "stops at 2 s", "start be before stop"},
        Case{"mass: 2 kg", "prescribed: { amplitude: [1, 0, 0] }", "21:30", "without a frequency", "frequency"},
        Case{"mass: 2 kg", "prescribed: { frequency: 3 }", "21:30", "without an amplitude", "amplitude"},
        Case{"mass: 2 kg", "prescribed: { phase: 90 deg }", "21:26", "a phase without an amplitude", "frequency"},
        Case{"mass: 2 kg", "mass: 2 kg\n    repeat: { count: [2, 1, 1], step: [0, 1, 1] }", "22:39", "lie at one place",
             "step"},
        Case{"mass: 2 kg", "mass: 2 kg\n    repeat: { count: [999, 999, 1], step: [1, 1, 1] }", "22:22",
             "more than 100000", "less often"},
        Case{kGood, "ballast: 1\n", "1:1", "neither fluids nor models", "Add fluids or models"},
        Case{kGood, "{ballast: 1, models: [{name: t, static: true, shape: {open_box: {inside: [1, 1, 1]}}}]}", "1:54",
             "no thickness", "Set wall"}));

INSTANTIATE_TEST_SUITE_P(
    Plane, Broken,
    ::testing::Values(Case{"dimension: 3\n  gravity: [0, 0", "dimension: 2\n  gravity: [0, 1", "5:12",
                           "gravity has a component 1 along y", "Set y to 0"},
                      Case{"3\n", "2\n  periodic: [y]\n  domain: { min: [0, 0, 0], max: [1, 1, 1] }\n", "5:13",
                           "y cannot be periodic", "Remove y"},
                      Case{kGood,
                           "{ballast: 1, world: {dimension: 2}, models: [{name: a, mass: 1, shape: "
                           "{box: [1, 1, 1]}, pose: [0, 1, 0]}]}",
                           "1:96", "pose has a component 1 along y", "y to 0"},
                      Case{kGood,
                           "{ballast: 1, world: {dimension: 2}, models: [{name: a, mass: 1, shape: "
                           "{box: [1, 1, 1]}, pose: [0, 0, 0, 1, 0, 0]}]}",
                           "1:96", "rotation in pose is not about y", "0"}));

// In dimension 2 a joint has to stay in the plane: read with the world changed by an override.
TEST(Plane, RefusesJointsThatLeaveIt) {
  const auto fails = [](const std::string& axis, const std::string& type) {
    const auto scene = read_scene_text(
        kGood, "s.yaml", {{"world.dimension", "2"}, {"joints.hinge.axis", axis}, {"joints.hinge.type", type}});
    return scene ? std::string() : scene.error().what;
  };
  EXPECT_EQ(fails("[0, 1, 0]", "revolute"), "");
  EXPECT_EQ(fails("[1, 0, 0]", "prismatic"), "");
  EXPECT_THAT(fails("[1, 0, 0]", "revolute"), HasSubstr("not about y"));
  EXPECT_THAT(fails("[0, 1, 0]", "prismatic"), HasSubstr("along y"));
  EXPECT_THAT(fails("[0, 0, 1]", "universal"), HasSubstr("out of the plane"));
}

// Whatever is cut off or scrambled: a value or an error, never a crash, and every error has place and cure.
TEST(Scenes, AnyDamageGivesASceneOrAnErrorWithPlaceAndCure) {
  int errors = 0;
  const std::string junk = "{}[]:,-&*!|>'\"%@`#\t0z\n";
  for (size_t i = 0; i < kGood.size(); ++i) {
    for (int how = 0; how < 3; ++how) {
      std::string text = kGood;
      if (how == 0) text.resize(i);
      if (how == 1) text[i] = junk[i % junk.size()];
      if (how == 2) text.erase(i, 1 + i % 7);
      const auto scene = read_scene_text(text, "s.yaml");
      if (scene) continue;
      ++errors;
      EXPECT_THAT(scene.error().where, HasSubstr("s.yaml"));
      EXPECT_FALSE(scene.error().what.empty());
      EXPECT_FALSE(scene.error().cure.empty()) << text;
    }
  }
  EXPECT_GT(errors, 1000);
}

}  // namespace
}  // namespace ballast
