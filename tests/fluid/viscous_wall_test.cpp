// What viscosity does at walls: the velocity of the fluid goes on beyond the surface in a straight line.
#include <gtest/gtest.h>

#include <numbers>

#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

constexpr double kViscosity = 10, kSpin = 1, kRadius = 0.12;  // Pa s, rad/s, m

/// Torque about y on a disc of six spacings per radius in the middle of fluid that turns rigidly, N m per metre of
/// depth.
double torque_on_disc(double spin_of_disc) {
  Scene scene;
  scene.world.dimension = 2;
  scene.world.spacing = 0.02;
  scene.world.gravity = Vec3::Zero();
  scene.numerics.relax = false;
  scene.numerics.sound_speed = 10;
  Fluid oil;
  oil.viscosity = kViscosity;
  oil.angular_velocity = {0, kSpin, 0};
  oil.fill.box = {{-0.4, -0.5, -0.4}, {0.4, 0.5, 0.4}};
  scene.fluids.push_back(oil);
  Model disc;
  disc.name = "disc";
  disc.shape.kind = ShapeKind::kCylinder;
  disc.shape.radius = kRadius;
  disc.shape.length = 1;
  disc.density = 1000;
  disc.angular_velocity = {0, spin_of_disc, 0};
  scene.models.push_back(disc);
  auto bodies = make_bodies(scene);
  if (!bodies) throw std::runtime_error(bodies.error().text());
  auto fluid = WcsphFluid::make(scene, *bodies, 1);
  if (!fluid) throw std::runtime_error(fluid.error().text());
  const std::vector<exchange::BodyState> states{initial_state(scene.models[0], (*bodies)[0], Vec3::Zero())};
  EXPECT_NEAR(Vec3::Map(states[0].angular_velocity)[1], spin_of_disc, 1e-12);
  (*fluid)->begin(states, 1e-6);
  return (*fluid)->wrenches()[0].torque[1];
}

TEST(ViscousWall, NothingHoldsADiscThatTurnsWithTheFluid) {
  const double scale = 4 * std::numbers::pi * kViscosity * kSpin * kRadius * kRadius;  // of a disc in fluid at rest
  EXPECT_NEAR(torque_on_disc(kSpin), 0, 1e-4 * scale);
  EXPECT_GT(torque_on_disc(0), scale);  // and one that stands is taken along
}

}  // namespace
}  // namespace ballast::fluid
