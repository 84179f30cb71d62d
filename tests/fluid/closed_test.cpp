// A fluid without a surface: the implicit solver's system hardly feels a uniform pressure.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {
namespace {

/// Taylor-Green vortices in a periodic square without friction keep their energy, rho U^2 / 4 per volume, and nothing
/// in them needs a pressure beyond rho U^2 / 2. (The particles' lattice tears at the saddle points later on.)
TEST(Closed, VorticesInAPeriodicBoxGoOn) {
  Scene scene;
  scene.world.dimension = 2;
  scene.world.spacing = 1.0 / 32;
  scene.world.gravity = Vec3::Zero();
  scene.world.periodic = {true, false, true};
  scene.world.domain = Box3{{0, -1, 0}, {1, 1, 1}};
  scene.numerics.pressure = Pressure::kImplicit;
  scene.numerics.artificial_viscosity = 0;
  Fluid water;
  water.viscosity = 0;
  water.vortex_speed = 1;
  water.fill.box = {{0, -0.5, 0}, {1, 0.5, 1}};
  scene.fluids.push_back(water);
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

}  // namespace
}  // namespace ballast::fluid
