// What the implicit solver does to bring crowded particles apart.
#include <gtest/gtest.h>

#include "common/geometry/bodies.h"
#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

/// Speed that water without weight, crowded around a cylinder by an unrelaxed start, has after one step, m/s.
double speed_after(double dt) {
  Scene scene;
  scene.world.dimension = 2;
  scene.world.spacing = 0.05;
  scene.world.gravity = Vec3::Zero();
  scene.numerics.pressure = Pressure::kImplicit;
  scene.numerics.relax = false;
  scene.numerics.sound_speed = 10;
  Model pillar = box_body("pillar", Vec3::Zero(), 0, {0.5, 0, 0.26});
  pillar.motion = Motion::kStatic;
  pillar.shape.kind = ShapeKind::kCylinder;
  pillar.shape.radius = 0.17, pillar.shape.length = 1;
  scene.models = {tank({1, 1, 1}), pillar};
  Fluid water;
  water.fill.box = {{0, -0.5, 0}, {1, 0.5, 0.5}};
  scene.fluids = {water};
  const auto bodies = make_bodies(scene);
  EXPECT_TRUE(bodies) << bodies.error().text();
  auto made = WcsphFluid::make(scene, *bodies, 1);
  EXPECT_TRUE(made) << made.error().text();
  std::vector<exchange::BodyState> states;
  for (std::size_t b = 0; b < bodies->size(); ++b)
    states.push_back(initial_state(scene.models[b], (*bodies)[b], scene.world.gravity));
  WcsphFluid& fluid = **made;
  fluid.begin(states, dt);
  fluid.move();
  return fluid.facts().max_speed;
}

/// If a step of any length moved them as far, short steps would make them fast, what is fast makes steps short, and a
/// run would end in steps of nanoseconds.
TEST(Correction, MakesNothingFasterInShorterSteps) {
  const double usual = speed_after(2e-2);  // 0.4 spacings at the speed that the sound speed stands for
  EXPECT_GT(usual, 1e-3) << "nothing was crowded: this test has no power";
  EXPECT_LT(speed_after(5e-5), 1.1 * usual);
  EXPECT_LT(speed_after(5e-7), 1.1 * usual);
}

}  // namespace
}  // namespace ballast::fluid
