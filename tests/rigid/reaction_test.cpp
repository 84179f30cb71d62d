// The acceleration without the fluid that an engine reports: with the reactions of contacts and joints as they were in
// the last step, but never an impact's. Oracles: equilibrium of forces.
#include <gtest/gtest.h>

#include "tests/support/rigid_fixture.h"

namespace ballast::testing {
namespace {

constexpr double kMass = 2;

/// What the fluid is told of body b: linear acceleration without the wrench.
Vec free_acceleration(Simulation& run, std::size_t b) {
  run.engine().mobility(run.states);
  return vec(run[b].free_acceleration);
}

TEST(Reaction, ABoxAtRestFallsOnlyByWhatTheFluidBears) {
  World world(kGravity);
  world.plane(Vec::UnitZ());
  const auto b = world.box(BodyMotion::kDynamic, kMass, {0.2, 0.2, 0.2}, {0, 0, 0.1});
  Simulation run("ode", world, 1e-3);
  const Vec lift(1, 0, 12);  // N; friction bears the first
  put(run.wrenches[b].force, lift);
  run.to(0.5);
  EXPECT_LT((free_acceleration(run, b) + lift / kMass).norm(), 1e-3 * kGravity);
}

TEST(Reaction, ABodyInFlightHasNone) {
  World world(kGravity);
  world.plane(Vec::UnitZ());
  const auto b = world.box(BodyMotion::kDynamic, kMass, {0.2, 0.2, 0.2}, {0, 0, 1});
  Simulation run("ode", world, 1e-3);
  run.to(0.1);
  EXPECT_EQ(free_acceleration(run, b), Vec(0, 0, -kGravity));
}

TEST(Reaction, AnImpactIsNotForwarded) {
  World world(kGravity);
  world.plane(Vec::UnitZ(), Vec::Zero(), 0.3, 0.5);
  const auto b = world.sphere(kMass, 0.1, {0, 0, 0.6}, 0.3, 0.5);
  Simulation run("ode", world, 1e-3);
  double most = 0, fastest = 0;
  run.to(0.5, [&] {  // falls 0.5 m in 0.32 s, comes back up at half its speed
    most = std::max(most, (free_acceleration(run, b) + Vec(0, 0, kGravity)).norm());
    fastest = std::max(fastest, run.velocity(b).z());
  });
  EXPECT_GT(fastest, 1);
  EXPECT_LT(most, 2 * kGravity) << "the bounce changes 4.7 m/s within a step: 480 g";
}

TEST(Reaction, AHingeBearsWhatHangsOnIt) {
  World world(kGravity);
  const auto b = world.box(BodyMotion::kDynamic, kMass, {0.1, 0.1, 0.1}, {0, 0, -0.5});
  world.joint(JointType::kRevolute, -1, b, {0, 0, 0});
  Simulation run("ode", world, 1e-3);
  run.to(0.1);
  EXPECT_LT(free_acceleration(run, b).norm(), 1e-6 * kGravity);
}

TEST(Reaction, IsSavedAndRestored) {
  World world(kGravity);
  world.plane(Vec::UnitZ());
  const auto b = world.box(BodyMotion::kDynamic, kMass, {0.2, 0.2, 0.2}, {0, 0, 0.1});
  Simulation run("ode", world, 1e-3);
  run.to(0.2);
  std::vector<std::byte> saved;
  run.engine().save(saved);
  const Vec before = free_acceleration(run, b);
  put(run.wrenches[b].force, {0, 0, 100});
  run.to(0.4);
  EXPECT_GT((free_acceleration(run, b) - before).norm(), 1);
  ASSERT_TRUE(run.engine().restore(saved));
  EXPECT_EQ(free_acceleration(run, b), before);
}

}  // namespace
}  // namespace ballast::testing
