// Release from rest, implicit: water that stands bears its pressure from the first step on, and does not sink to it.
#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/bodies.h"
#include "fluid_server/pressure/implicit.h"
#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

class Release : public testing::Test {
 protected:
  static constexpr double kDepth = 0.5, kSpacing = 0.025, kGravity = 9.80665;

  static Scene standing_water() {
    Scene scene;
    scene.world.dimension = 2;
    scene.world.spacing = kSpacing;
    scene.numerics.pressure = Pressure::kImplicit;
    scene.models = {tank({1, 1, 1})};
    Fluid water;
    water.fill.box = {{0, -0.5, 0}, {1, 0.5, kDepth}};
    scene.fluids = {water};
    return scene;
  }

  Release() {
    bodies = *make_bodies(scene);
    fluid = *WcsphFluid::make(scene, bodies, 1);
    states = {initial_state(scene.models[0], bodies[0], scene.world.gravity)};
    const double dt = 0.2 * std::sqrt(kSpacing / kGravity);
    fluid->begin(states, dt), fluid->move();
  }

  Scene scene = standing_water();
  std::vector<Body> bodies;
  std::unique_ptr<WcsphFluid> fluid;
  std::vector<exchange::BodyState> states;
};

/// p / (rho c^2) with c four times the scene's sound speed. Particle by particle a solve may leave as much; in the mean
/// over many it does not.
TEST_F(Release, CompressesWaterByTheWeightAboveIt) {
  const double c = 4 * fluid->constants().sound_speed;
  double off = 0, number = 0;
  for (std::size_t f = 0; f < fluid->particles().size(); ++f) {
    const Record& r = fluid->particles().record[f];
    const double weight = kGravity * (kDepth - fluid->coordinates().to_metres(r.x, r.y, r.z)[2]);
    if (weight > 2 * kGravity * kSpacing) {
      EXPECT_NEAR(r.p, 1000 * weight, 0.02 * 1000 * kGravity * kDepth);
    }
    off += fluid->particles().compression[f] - weight / (c * c);
    ++number;
  }
  ASSERT_EQ(number, 800);
  EXPECT_NEAR(off / number, 0, 0.02 * kGravity * kDepth / (c * c));
}

/// Water that sinks by its compression in one step does so at g H^2 / (2 c^2) / dt, 18 mm/s at the surface.
TEST_F(Release, LeavesStandingWaterWhereItIs) {
  double sum = 0;
  for (const Record& r : fluid->particles().record) sum += r.vz;
  EXPECT_LT(std::abs(sum) / static_cast<double>(fluid->particles().size()), 2e-4);
}

TEST_F(Release, FindsThePressureInAFewRounds) {
  EXPECT_GE(fluid->implicit()->report().release_rounds, 2);
  EXPECT_LE(fluid->implicit()->report().release_rounds, 10);
  EXPECT_LT(fluid->implicit()->report().release_change, 1e-3);
}

}  // namespace
}  // namespace ballast::fluid
