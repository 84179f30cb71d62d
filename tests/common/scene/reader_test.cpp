// A good scene arrives with every value where it belongs.
#include "common/scene/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>

#include "tests/common/scene/scenes.h"

namespace ballast {
namespace {

Scene rich() {
  auto scene = read_scene_text(scene::kRich, "folder/rich.yaml");
  EXPECT_TRUE(scene) << scene.error().text();
  return scene ? *scene : Scene{};
}

const Model& model(const Scene& scene, const std::string& name) {
  for (const Model& m : scene.models) {
    if (m.name == name) return m;
  }
  throw std::runtime_error("no model " + name);
}

TEST(Reader, TakesTheWorldWithUnits) {
  const Scene scene = rich();
  EXPECT_EQ(scene.name, "rich");
  EXPECT_EQ(scene.world.spacing, 0.02);
  EXPECT_EQ(scene.world.accuracy, Accuracy::kAccurate);
  EXPECT_THAT(scene.world.periodic, ::testing::ElementsAre(true, true, false));
  EXPECT_EQ(scene.world.domain->max, Vec3(3, 3, 3));
  EXPECT_EQ(scene.world.seed, 18446744073709551615ull);
}

TEST(Reader, TakesMaterialsAndWhatOverridesThem) {
  const Scene scene = rich();
  EXPECT_EQ(scene.fluids[0].density, 1000);
  EXPECT_EQ(scene.fluids[0].viscosity, 1e-3);
  EXPECT_DOUBLE_EQ(scene.fluids[0].fill.box.max.z(), 0.6);
  EXPECT_EQ(scene.fluids[1].density, 900);
  EXPECT_EQ(scene.fluids[1].fill.container, "tank");
  const auto thick = read_scene_text(scene::kRich, "f", {{"fluids.water.viscosity", "1 Pa s"}});
  ASSERT_TRUE(thick) << thick.error().text();
  EXPECT_EQ(thick->fluids[0].viscosity, 1);
  EXPECT_EQ(thick->fluids[0].density, 1000);
}

TEST(Reader, RepeatsModelsOnAGrid) {
  const Scene scene = rich();
  int crates = 0;
  for (int x = 0; x < 2; ++x) {
    for (int z = 0; z < 3; ++z) {
      const Model& crate = model(scene, "crate_" + std::to_string(x) + "_0_" + std::to_string(z));
      EXPECT_TRUE(crate.pose.position.isApprox(Vec3(1.1 + 0.12 * x, 0.3, 0.06 + 0.13 * z), 1e-15));
      EXPECT_EQ(crate.density, 500);
      ++crates;
    }
  }
  EXPECT_EQ(static_cast<int>(scene.models.size()), crates + 6);
}

TEST(Reader, TurnsAnglesLikeGazebo) {
  const std::string text = R"({ballast: 1, models: [{name: a, mass: 1, shape: {sphere: {radius: 1}},
    pose: [0, 0, 0, 10 deg, 20 deg, 30 deg]}]})";
  const auto scene = read_scene_text(text, "f");
  ASSERT_TRUE(scene) << scene.error().text();
  const double d = std::numbers::pi / 180, cr = cos(10 * d), sr = sin(10 * d), cp = cos(20 * d), sp = sin(20 * d),
               cy = cos(30 * d), sy = sin(30 * d);
  Eigen::Matrix3d expected;  // Rz(yaw) Ry(pitch) Rx(roll), written out
  expected << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr,
      sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr;
  EXPECT_TRUE(scene->models[0].pose.rotation.toRotationMatrix().isApprox(expected, 1e-14));
}

TEST(Reader, TakesShapesAndMotions) {
  const Scene scene = rich();
  EXPECT_EQ(model(scene, "tank").motion, Motion::kStatic);
  EXPECT_TRUE(model(scene, "tank").shape.lid);
  EXPECT_EQ(model(scene, "paddle").motion, Motion::kPrescribed);
  EXPECT_EQ(model(scene, "paddle").prescription.frequency, 2);
  EXPECT_EQ(model(scene, "paddle").shape.parts.size(), 2u);
  EXPECT_NEAR(model(scene, "paddle").shape.parts[1].pose.rotation.norm(), 1, 1e-15);
  EXPECT_EQ(model(scene, "bowl").shape.kind, ShapeKind::kSphere);
  EXPECT_TRUE(model(scene, "bowl").shape.hollow);
  EXPECT_DOUBLE_EQ(model(scene, "bowl").shape.wall, 0.04);
  EXPECT_FALSE(model(scene, "ball").shape.hollow);
}

TEST(Reader, TakesJointsInTheUnitsOfTheirKind) {
  const Scene scene = rich();
  EXPECT_DOUBLE_EQ(*scene.joints[0].lower, -std::numbers::pi / 6);
  EXPECT_DOUBLE_EQ(scene.joints[0].motor_velocity, 2 * std::numbers::pi);
  EXPECT_FALSE(scene.joints[2].lower);
  EXPECT_EQ(*scene.joints[2].upper, 2);
}

TEST(Reader, TellsAbsoluteFromRelativeTolerances) {
  const Scene scene = rich();
  EXPECT_EQ(*scene.expects[3].within_relative, 0.07);
  EXPECT_FALSE(scene.expects[3].within);
  EXPECT_EQ(*scene.expects[5].within, 1e-3);
  EXPECT_FALSE(scene.expects[5].within_relative);
}

TEST(Reader, KnowsTheLineOfEveryItem) {
  const Scene scene = rich();
  EXPECT_EQ(scene.fluids[0].place.line, 6);
  EXPECT_EQ(scene.fluids[0].place.column, 5);
  EXPECT_EQ(scene.fluids[0].place.file, "folder/rich.yaml");
}

TEST(Reader, MakesMeshPathsAbsoluteFromTheFolderOfTheScene) {
  const auto folder = std::filesystem::temp_directory_path() / ("ballast_reader_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "meshes");
  std::ofstream(folder / "meshes/duck.obj") << "v 0 0 0\n";
  std::ofstream(folder / "duck.yaml")
      << "{ballast: 1, models: [{name: duck, mass: 1, shape: {mesh: {file: meshes/duck.obj, scale: 2}}}]}";
  const auto scene = read_scene((folder / "duck.yaml").string());
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->name, "duck");
  EXPECT_EQ(scene->models[0].shape.mesh, (folder / "meshes/duck.obj").string());
  EXPECT_EQ(scene->models[0].shape.scale, Vec3(2, 2, 2));
}

TEST(Reader, SaysThatAFileIsNotThere) {
  for (const char* path : {"no/such/scene.yaml", "/"}) {
    const auto scene = read_scene(path);
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().where, path);
    EXPECT_EQ(scene.error().exit_code, kBadInput);
  }
}

}  // namespace
}  // namespace ballast
