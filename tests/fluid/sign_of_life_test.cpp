// Signs of life: a process that computes is not taken for one that hangs, however many particles it has.
#include <gtest/gtest.h>

#include "common/geometry/bodies.h"
#include "fluid_server/pressure/implicit.h"
#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

Scene breaking_dam(Pressure pressure) {
  Scene scene;
  scene.world.dimension = 2;
  scene.world.spacing = 0.05;
  scene.numerics.pressure = pressure;
  scene.models = {tank({1, 1, 1})};
  Fluid water;
  water.fill.box = {{0, -0.5, 0}, {0.5, 0.5, 0.5}};
  scene.fluids = {water};
  return scene;
}

/// Signs of life in a step, and the products of its solve.
std::pair<int, int> signs_and_products(Pressure pressure) {
  const Scene scene = breaking_dam(pressure);
  const auto bodies = make_bodies(scene);
  int signs = 0;
  auto fluid = *WcsphFluid::make(scene, *bodies, 1, [&signs] { ++signs; });
  const std::vector states{initial_state(scene.models[0], (*bodies)[0], scene.world.gravity)};
  signs = 0;
  fluid->begin(states, 1e-3), fluid->move();
  return {signs, fluid->implicit() ? static_cast<int>(fluid->implicit()->report().products) : 0};
}

TEST(SignOfLife, IsGivenInEveryProductOfASolve) {
  const auto [signs, products] = signs_and_products(Pressure::kImplicit);
  ASSERT_GT(products, 1);
  EXPECT_GE(signs, products);
}

TEST(SignOfLife, IsGivenWithinAnExplicitStep) { EXPECT_GE(signs_and_products(Pressure::kWcsph).first, 3); }

}  // namespace
}  // namespace ballast::fluid
