// print_scene reads back to the same scene, and the hash sees every change.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/scene/reader.h"
#include "tests/common/scene/scenes.h"

namespace ballast {
namespace {

Scene read(const std::string& text, const Overrides& overrides = {}) {
  auto scene = read_scene_text(text, "f.yaml", overrides);
  EXPECT_TRUE(scene) << scene.error().text();
  return scene ? *scene : Scene{};
}

TEST(Printer, RoundTripsARichScene) {
  const Scene scene = read(scene::kRich);
  const std::string text = print_scene(scene);
  const Scene again = read(text);
  EXPECT_EQ(print_scene(again), text);
  ASSERT_EQ(again.models.size(), scene.models.size());
  for (size_t i = 0; i < scene.models.size(); ++i) {  // to the last bit, beside the text
    EXPECT_EQ(again.models[i].pose.position, scene.models[i].pose.position);
    EXPECT_EQ(again.models[i].pose.rotation.coeffs(), scene.models[i].pose.rotation.coeffs());
    EXPECT_EQ(again.models[i].motion, scene.models[i].motion);
    EXPECT_EQ(again.models[i].shape.kind, scene.models[i].shape.kind);
    EXPECT_EQ(again.models[i].shape.hollow, scene.models[i].shape.hollow);
    EXPECT_EQ(again.models[i].prescription.stop, scene.models[i].prescription.stop);
  }
  EXPECT_EQ(again.expects[3].within_relative, scene.expects[3].within_relative);
  EXPECT_EQ(again.world.seed, scene.world.seed);
}

TEST(Differences, AreThePathsOfTheKeys) {
  const Scene scene = read(scene::kRich);
  EXPECT_TRUE(scene_differences(scene, read(print_scene(scene))).empty());
  const Scene other =
      read(scene::kRich, {{"world.duration", "4 s"}, {"models.ball.mass", "3"}, {"output.vtk", "false"}});
  EXPECT_THAT(scene_differences(scene, other),
              ::testing::UnorderedElementsAre("/world/duration", "/models/ball/mass", "/output/vtk"));
  Scene more = scene;
  more.models.insert(more.models.begin(), more.models.back());
  more.models.front().name = "another";
  EXPECT_THAT(scene_differences(scene, more), ::testing::ElementsAre("/models/another"));
}

TEST(Printer, KeepsEveryBitOfAwkwardNumbersAndTexts) {
  for (const char* number : {"0.1", "1e-300", "12345.678901234567", "0.30000000000000004", "-0.0", "1e5"}) {
    const Scene scene = read(scene::kRich, {{"models.ball.velocity", std::string("[") + number + ", 0, 0]"}});
    const auto text = print_scene(scene);
    EXPECT_EQ(print_scene(read(text)), text) << number;
  }
  for (const char* words :
       {"null", "'a: b # c'", "\"two\\nlines \\\"quoted\\\"\"", "'  '", "'- x'", "\u00fcber", "'1'", "'~'"}) {
    const Scene scene = read(scene::kRich, {{"description", std::string(words) == "null" ? "'null'" : words}});
    EXPECT_EQ(read(print_scene(scene)).description, scene.description) << words;
  }
  for (int i = 1; i < 20000; i += 371) {
    const Scene scene = read(scene::kRich, {{"expect.3.column.within", std::to_string(i * 0.01) + " %"}});
    EXPECT_EQ(read(print_scene(scene)).expects[3].within_relative, scene.expects[3].within_relative) << i;
  }
}

TEST(Hash, IsTheSameForTheSameSceneAndChangesWithEveryValue) {
  const std::uint64_t hash = scene_hash(read(scene::kRich));
  EXPECT_EQ(scene_hash(read(print_scene(read(scene::kRich)))), hash);
  EXPECT_EQ(scene_hash(read(scene::kRich, {{"output.every", "0.02"}})), hash) << "20 ms and 0.02 are one value";
  EXPECT_NE(scene_hash(read(scene::kRich, {{"output.every", "0.020000000000000004"}})), hash);
  EXPECT_NE(scene_hash(read(scene::kRich, {{"models.floor.friction", "0.31"}})), hash);
}

TEST(Hash, IsFnv1aOfThePrintedText) {
  const Scene scene = read(scene::kRich);
  std::uint64_t hash = 0xcbf29ce484222325;  // offset basis and prime as published by Fowler, Noll and Vo
  for (const unsigned char c : print_scene(scene)) hash = (hash ^ c) * 0x100000001b3;
  EXPECT_EQ(scene_hash(scene), hash);
}

}  // namespace
}  // namespace ballast
