// Filling: fluids that touch leave nothing between them, fluids that overlap are refused, and bodies that do not fit
// the lattice leave as much fluid on each of their sides as there is room.
#include "fluid_server/particles/fill.h"

#include <gtest/gtest.h>

#include <numbers>

#include "common/geometry/bodies.h"
#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

Fluid box(const char* name, double from, double to) {
  Fluid fluid;
  fluid.name = name;
  fluid.fill.kind = FillKind::kBox;
  fluid.fill.box = {{from, 0, 0}, {to, 0.5, 0.5}};
  return fluid;
}

Result<Filled> filled(const Scene& scene) {
  const Coordinates coordinates = Coordinates::make({{-1, -1, -1}, {2, 2, 2}}, {});
  auto bodies = make_bodies(scene);
  EXPECT_TRUE(bodies);
  return fill_fluids(scene, *bodies, coordinates, 0.145);
}

Scene two(double second_from) {
  Scene scene;
  scene.world.spacing = 0.05;
  scene.fluids = {box("left", 0, 0.5), box("right", second_from, 1)};
  return scene;
}

TEST(Fill, NoGhostStandsWhereAnotherFluidIs) {
  const Coordinates coordinates = Coordinates::make({{-1, -1, -1}, {2, 2, 2}}, {});
  const auto result = filled(two(0.5));
  ASSERT_TRUE(result) << result.error().text();
  EXPECT_EQ(result->particles.size(), 2000u);
  EXPECT_FALSE(result->ghosts.empty());
  for (const Record& g : result->ghosts) {
    const Vec3 p = coordinates.to_metres(g.x, g.y, g.z);
    EXPECT_FALSE((p.array() > 0.001).all() && p[0] < 0.999 && p[1] < 0.499 && p[2] < 0.499) << p.transpose();
  }
}

TEST(Fill, OverlappingFluidsAreRefusedByName) {
  const auto result = filled(two(0.2));
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().text().find("'right' overlaps"), std::string::npos) << result.error().text();
}

TEST(Fill, VorticesNeitherStretchNorEndAtABorder) {
  Scene scene;
  scene.world.spacing = 0.05;
  Fluid water = box("water", 0, 1);
  water.vortex_speed = 3;
  water.vortex_wavelength = 0.5;
  scene.fluids = {water};
  const auto result = filled(scene);
  ASSERT_TRUE(result) << result.error().text();
  const Coordinates coordinates = Coordinates::make({{-1, -1, -1}, {2, 2, 2}}, {});
  for (const Record& r : result->particles.record) {
    const Vec3 p = coordinates.to_metres(r.x, r.y, r.z) * (2 * std::numbers::pi / 0.5);
    EXPECT_NEAR(r.vx, -3 * std::cos(p[0]) * std::sin(p[2]), 1e-5);
    EXPECT_EQ(r.vy, 0);
    EXPECT_NEAR(r.vz, 3 * std::sin(p[0]) * std::cos(p[2]), 1e-5);
  }
}

TEST(Fill, StrainStretchesAlongXAboutTheCentre) {
  Scene scene;
  scene.world.spacing = 0.05;
  Fluid water = box("water", 0, 1);  // 0 .. 1 along x, 0 .. 0.5 along y and z
  water.strain = 4;
  scene.fluids = {water};
  const auto result = filled(scene);
  ASSERT_TRUE(result) << result.error().text();
  const Coordinates coordinates = Coordinates::make({{-1, -1, -1}, {2, 2, 2}}, {});
  for (const Record& r : result->particles.record) {
    const Vec3 p = coordinates.to_metres(r.x, r.y, r.z);
    EXPECT_NEAR(r.vx, 4 * (p[0] - 0.5), 1e-5);
    EXPECT_EQ(r.vy, 0);
    EXPECT_NEAR(r.vz, -4 * (p[2] - 0.25), 1e-5);
  }
}

/// A box half under water between two channels, shifted by shares of a spacing against the lattice.
class Shifted : public ::testing::TestWithParam<double> {
 protected:
  Shifted() {
    scene_.world.dimension = 2;
    scene_.world.spacing = kSpacing;
    scene_.models = {tank({2, 1, 1.5}, {0, -0.5, 0}),
                     box_body("body", {1, 1, 0.5}, 500, {1 + GetParam() * kSpacing, 0, 1})};
    Fluid water;
    water.fill.box = {{0, -0.5, 0}, {2, 0.5, 1}};
    scene_.fluids = {water};
    bodies_ = *make_bodies(scene_);
    fluid_ = *WcsphFluid::make(scene_, bodies_, 1);
  }
  std::vector<Vec3> places() const {
    std::vector<Vec3> all;
    for (const Record& r : fluid_->particles().record) all.push_back(fluid_->coordinates().to_metres(r.x, r.y, r.z));
    return all;
  }
  static constexpr double kSpacing = 0.05;
  Scene scene_;
  std::vector<Body> bodies_;
  std::unique_ptr<WcsphFluid> fluid_;
};

TEST_P(Shifted, EachChannelHoldsTheVolumeThatItHasRoomFor) {
  const double left = 0.5 + GetParam() * kSpacing, right = 1 - left;
  double in_left = 0, in_right = 0;
  for (const Vec3& p : places()) {
    if (p[2] < 0.75) continue;
    (p[0] < 1 ? in_left : in_right) += fluid_->particles().record[0].volume;
  }
  const double particle = kSpacing * kSpacing;
  EXPECT_NEAR(in_left, 0.25 * left, 1.5 * particle);
  EXPECT_NEAR(in_right, 0.25 * right, 1.5 * particle);
}

TEST_P(Shifted, RelaxingEndsWithAnEvenFluidBelowItsSurface) {
  const RelaxReport& relaxed = fluid_->relax_report();
  EXPECT_TRUE(relaxed.settled) << relaxed.last_move;
  EXPECT_LT(relaxed.moves, 500);
  EXPECT_LE(relaxed.spread_after, 0.005);
  for (const Vec3& p : places()) EXPECT_LT(p[2], 1) << "a particle left through the surface at x = " << p[0];
}

INSTANTIATE_TEST_SUITE_P(BySpacings, Shifted, ::testing::Values(0.0, 0.1, 0.25, 0.26, 0.4, 0.5));

}  // namespace
}  // namespace ballast::fluid
