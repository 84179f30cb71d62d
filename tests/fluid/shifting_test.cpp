// Particle shifting: flows whose lattice would tear keep to their exact solution, and what is at rest is left alone.
#include "fluid_server/step/shifting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fluid_server/step/step_control.h"
#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

Scene sheared(When shifting) {
  Scene scene = vortices(10);  // Reynolds number 100
  scene.numerics.sound_speed = 10;
  scene.numerics.shifting = shifting;
  return scene;
}

struct Flowing {
  std::unique_ptr<WcsphFluid> fluid;
  double time = 0;
  explicit Flowing(const Scene& scene, int threads = 1) {
    auto made = WcsphFluid::make(scene, {}, threads);
    if (!made) throw std::runtime_error(made.error().text());
    fluid = std::move(*made);
  }
  void run(double until) {
    const double dt = 0.25 * fluid->constants().kernel.h() / 11;
    for (; time < until; time += dt) fluid->begin({}, dt), fluid->move();
  }
  /// Kinetic energy over rho U^2 / 4 per volume times exp(-16 pi^2 nu t), 1 in an exact flow.
  double kept() const {
    return fluid->measure().kinetic / (250 * std::exp(-16 * std::numbers::pi * std::numbers::pi * 0.01 * time));
  }
};

TEST(Shifting, VorticesDecayByViscosityAlone) {
  Flowing with(sheared(When::kAlways)), without(sheared(When::kNever));
  with.run(1), without.run(1);
  EXPECT_NEAR(with.kept(), 1, 0.06);  // a speed off by 3 %, with 32 particles along a pair of vortices
  EXPECT_LT(without.kept(), 0.8) << "this test had no power: the lattice did not tear";
  const ShiftReport& report = *with.fluid->shifting();
  EXPECT_LE(report.largest, 0.0501);
  EXPECT_GT(report.mean / static_cast<double>(report.steps), 0);
  EXPECT_EQ(without.fluid->shifting(), nullptr);
}

/// With the steps that the implicit solver takes where particles are shifted.
TEST(Shifting, KeepsUpWithTheImplicitSolver) {
  const auto kept = [](When shifting) {
    Scene scene = sheared(shifting);
    scene.numerics.pressure = Pressure::kImplicit;
    Flowing flow(scene);
    for (const double dt = kLongestShiftedMove * scene.world.spacing; flow.time < 1; flow.time += dt)
      flow.fluid->begin({}, dt), flow.fluid->move();
    return flow.kept();
  };
  EXPECT_NEAR(kept(When::kAlways), 1, 0.15);  // a speed off by 7 %
  EXPECT_LT(kept(When::kNever), 0.6) << "this test had no power: the lattice did not tear";
}

TEST(Shifting, MovesWithoutTouchingMomentum) {
  Flowing flow(sheared(When::kAlways));
  flow.run(0.2);
  const Measures m = flow.fluid->measure();
  EXPECT_LT(m.momentum.norm(), 1e-4 * m.mass) << "of 1 m/s";
}

TEST(Shifting, KeepsTheAngularMomentumOfAPatchThatTurns) {
  Scene scene = sheared(When::kAlways);
  scene.world.periodic = {false, false, false};
  scene.world.domain = Box3{{-1, -1, -1}, {2, 1, 2}};
  scene.fluids[0].vortex_speed = 0;
  scene.fluids[0].viscosity = 0;
  scene.fluids[0].velocity = {0.5, 0, 0};
  scene.fluids[0].angular_velocity = {0, 1, 0};
  Flowing flow(scene);
  const Measures before = flow.fluid->measure();
  flow.run(1);
  const Measures after = flow.fluid->measure();
  EXPECT_GT(flow.fluid->shifting()->largest, 0.002) << "this test had no power: nothing was shifted";
  EXPECT_NEAR(after.angular_momentum[1], before.angular_momentum[1], 1e-5 * std::abs(before.angular_momentum[1]));
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-5 * before.momentum.norm());
}

/// A free body takes what the patch gives: nothing else is to be lost, whatever is moved. Here it is held where it is.
TEST(Shifting, KeepsTheAngularMomentumOfAPatchAndAFreeBody) {
  Scene scene = sheared(When::kAlways);
  scene.world.periodic = {false, false, false};
  scene.world.domain = Box3{{-1, -1, -1}, {2, 1, 2}};
  scene.fluids[0].vortex_speed = 0;
  scene.fluids[0].viscosity = 0;
  scene.fluids[0].angular_velocity = {0, 1, 0};
  scene.models = {box_body("box", {0.2, 1, 0.3}, 500, {0.6, 0, 0.55})};
  const std::vector<Body> bodies = *make_bodies(scene);
  const std::vector states{initial_state(scene.models[0], bodies[0], scene.world.gravity)};
  auto fluid = *WcsphFluid::make(scene, bodies, 1);
  const double start = fluid->measure().angular_momentum[1], dt = 0.25 * fluid->constants().kernel.h() / 11;
  double given = 0;
  for (int n = 0; n < 400; ++n) {
    fluid->begin(states, dt);
    const exchange::Wrench& w = fluid->wrenches()[0];
    given += dt * (Vec3::Map(states[0].position).cross(Vec3::Map(w.force)) + Vec3::Map(w.torque))[1];
    fluid->move();
  }
  EXPECT_GT(fluid->shifting()->largest, 0.002) << "this test had no power: nothing was shifted";
  EXPECT_NEAR(fluid->measure().angular_momentum[1] + given, start, 1e-5 * std::abs(start));
}

/// The mean pressure follows the mean summed density with shifting, as it does without.
TEST(Shifting, UndoesNoCompressionInSecret) {
  Flowing flow(sheared(When::kAlways));
  const auto off = [&] {  // mean of summed density less p / (rho c^2)
    Particles particles = flow.fluid->particles(), sorted;
    const PassConstants& constants = flow.fluid->constants();
    Neighbourhood items(flow.fluid->coordinates(), constants.kernel.support, 2, 1);
    items.rebuild(particles, sorted, {}, 0);
    build_lists(items, constants);
    std::vector<float> delta, gradient;
    sum_density(items, constants, delta, gradient);
    double sum = 0;
    for (std::size_t f = 0; f < sorted.size(); ++f) sum += delta[f] - sorted.record[f].p / (1000 * 100);
    return sum / static_cast<double>(sorted.size());
  };
  const double before = off();
  flow.run(0.5);
  EXPECT_NEAR(off(), before, 2e-3);
}

TEST(Shifting, LeavesAloneWhatIsAtRestAndWhatMovesAsOne) {
  Scene scene = sheared(When::kAlways);
  scene.fluids[0].vortex_speed = 0;
  Flowing rest(scene);
  rest.run(0.05);
  EXPECT_EQ(rest.fluid->shifting()->largest, 0);
}

TEST(Shifting, IsTheSameForAnyNumberOfThreads) {
  Flowing one(sheared(When::kAlways), 1), two(sheared(When::kAlways), 2);
  one.run(0.05), two.run(0.05);
  EXPECT_EQ(one.fluid->hash(), two.fluid->hash());
}

}  // namespace
}  // namespace ballast::fluid
