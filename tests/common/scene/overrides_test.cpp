// --set path=value: reaches every key, adds those that are absent, replaces those that exclude it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/scene/reader.h"
#include "tests/common/scene/scenes.h"

namespace ballast {
namespace {

using ::testing::HasSubstr;

Scene with(const Overrides& overrides) {
  auto scene = read_scene_text(scene::kRich, "rich.yaml", overrides);
  EXPECT_TRUE(scene) << scene.error().text();
  return scene ? *scene : Scene{};
}

const Model& ball(const Scene& scene) {
  for (const Model& m : scene.models) {
    if (m.name == "ball") return m;
  }
  throw std::runtime_error("no ball");
}

TEST(Overrides, ReplaceValuesByNameAndByIndex) {
  EXPECT_EQ(with({{"world.duration", "20 ms"}}).world.duration, 0.02);
  EXPECT_EQ(with({{"fluids.1.density", "800"}}).fluids[1].density, 800);
  EXPECT_EQ(ball(with({{"models.ball.pose.2", "7"}})).pose.position.z(), 7);
  EXPECT_EQ(ball(with({{"models.ball.pose", "[1, 2, 3]"}})).pose.position, Vec3(1, 2, 3));
  EXPECT_EQ(*with({{"expect.4.column.below", "2"}}).expects[4].below, 2);
}

TEST(Overrides, AddKeysThatAreAbsent) {
  EXPECT_EQ(with({{"fluids.water.viscosity", "0.1"}}).fluids[0].viscosity, 0.1);
  const auto scene = read_scene_text("{ballast: 1, models: [{name: a, static: true, shape: {box: [1, 1, 1]}}]}", "f",
                                     {{"coupling.scheme", "staggered"}, {"world.seed", "7"}});
  ASSERT_TRUE(scene) << scene.error().text();
  EXPECT_EQ(scene->coupling.scheme, "staggered");
  EXPECT_EQ(scene->world.seed, 7u);
}

TEST(Overrides, ReplaceWhatExcludesThem) {
  const Scene heavy = with({{"models.ball.density", "100"}});
  EXPECT_EQ(ball(heavy).density, 100);
  EXPECT_EQ(ball(heavy).mass, 0);
  const Scene cube = with({{"models.ball.shape.box", "[1, 1, 1]"}});
  EXPECT_EQ(ball(cube).shape.kind, ShapeKind::kBox);
  EXPECT_EQ(ball(cube).shape.radius, 0) << "the sphere left something behind";
  const Scene last = with({{"models.ball.density", "100"}, {"models.ball.mass", "3"}});
  EXPECT_EQ(ball(last).mass, 3);
  EXPECT_EQ(ball(last).density, 0);
}

TEST(Overrides, UseTheUnexpandedNameOfRepeatedModels) {
  const Scene scene = with({{"models.crate.density", "123"}, {"models.crate.repeat.count", "[2, 1, 4]"}});
  int crates = 0;
  for (const Model& m : scene.models) crates += m.name.starts_with("crate_") && m.density == 123;
  EXPECT_EQ(crates, 8);
}

struct Bad {
  const char *path, *value, *what, *cure;
};

class BadOverrides : public ::testing::TestWithParam<Bad> {};

TEST_P(BadOverrides, AreRefusedWithTheirPath) {
  const Bad& bad = GetParam();
  const auto scene = read_scene_text(scene::kRich, "rich.yaml", {{bad.path, bad.value}});
  ASSERT_FALSE(scene) << bad.path;
  EXPECT_EQ(scene.error().where, std::string("--set ") + bad.path);
  EXPECT_THAT(scene.error().what, HasSubstr(bad.what));
  EXPECT_THAT(scene.error().cure, HasSubstr(bad.cure));
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadOverrides,
    ::testing::Values(Bad{"models.ball.dnesity", "1", "'dnesity' is not known", "Did you mean 'density'?"},
                      Bad{"models.bal.density", "1", "no list item 'bal'", "Did you mean 'ball'?"},
                      Bad{"models.99.density", "1", "no list item '99'", "Known here"},
                      Bad{"wrold.duration", "1", "'wrold' is not known", "Did you mean 'world'?"},
                      Bad{"world.duration.x", "1", "leads into the plain value", "End the path"},
                      Bad{"world.duration", "[1", "cannot be read", "as it would stand"},
                      Bad{"world.duration", "", "cannot be read", "as it would stand"},
                      Bad{"world.duration", "5 cm", "is a length (m), but a time (s) is needed", "Write it in s"},
                      Bad{"world..duration", "1", "empty step", "key.name.key=value"},
                      Bad{"", "1", "path is empty", "--set"},
                      Bad{"joints.hinge.child", "bal", "'bal' is not a model", "Did you mean 'ball'?"},
                      Bad{"world.gravity.7", "1", "no list item '7'", "from 0 to 2"}));

}  // namespace
}  // namespace ballast
