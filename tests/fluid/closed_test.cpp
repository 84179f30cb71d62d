// A fluid without a surface: the implicit solver's system hardly feels a uniform pressure.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

/// Taylor-Green vortices in a periodic square without friction keep their energy, rho U^2 / 4 per volume, and nothing
/// in them needs a pressure beyond rho U^2 / 2. (The particles' lattice tears at the saddle points later on.)
TEST(Closed, VorticesInAPeriodicBoxGoOn) {
  Scene scene = vortices(0);
  scene.numerics.pressure = Pressure::kImplicit;
  auto made = WcsphFluid::make(scene, {}, 1);
  ASSERT_TRUE(made) << made.error().text();
  WcsphFluid& fluid = **made;
  for (int step = 0; step < 5; ++step) {
    fluid.begin({}, 0.01);
    double uniform = 0;
    for (const Record& r : fluid.particles().record) uniform += r.p / static_cast<double>(fluid.particles().size());
    EXPECT_LT(std::abs(uniform), 500) << "rho U^2 / 2, Pa";
    fluid.move();
  }
  EXPECT_NEAR(fluid.measure().kinetic, 250, 0.05 * 250);
}

/// What particles do to each other cancels, so that the whole drop gets rate^2 times its distance from the centre.
TEST(Closed, AttractionMovesADropTowardsItsCentre) {
  Scene scene;
  scene.world.dimension = 2;
  scene.world.spacing = 0.05;
  scene.world.gravity = Vec3::Zero();
  scene.world.attraction_rate = 3;
  scene.world.attraction_centre = {0.1, 7, -0.4};  // the y is outside the plane
  scene.world.domain = Box3{{-2, -1, -2}, {3, 1, 3}};
  Fluid water;
  water.fill.box = {{0, -0.5, 0}, {1, 0.5, 0.5}};
  scene.fluids.push_back(water);
  auto made = WcsphFluid::make(scene, {}, 1);
  ASSERT_TRUE(made) << made.error().text();
  WcsphFluid& fluid = **made;
  const Vec3 way(0.5 - 0.1, 0, 0.25 + 0.4);
  const double dt = 1e-3, mass = 500;
  fluid.begin({}, dt);
  fluid.move();
  EXPECT_LT((fluid.measure().momentum + 9 * dt * mass * way).norm(), 1e-3 * 9 * dt * mass * way.norm());
}

}  // namespace
}  // namespace ballast::fluid
