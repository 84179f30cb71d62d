// Save, restore and replay: the same bits, whatever happened in between.
#include <algorithm>
#include <cstring>

#include "tests/rigid/conformance.h"

namespace ballast::testing {

using Replay = EveryEngine;
FOR_EVERY_ENGINE(Replay);

bool same_bits(const std::vector<BodyState>& a, const std::vector<BodyState>& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(BodyState)) == 0;
}

/// A pile that is still collapsing, with many contacts: spheres and boxes dropped on a floor.
World pile() {
  World world;
  world.plane({0, 0, 1}, {0, 0, 0}, 0.3, 0.2);
  for (int i = 0; i < 16; ++i) {
    const Vec at(0.07 * (i % 2) + 0.003 * i, 0.06 * (i / 2 % 2), 0.06 + 0.11 * (i / 4));
    i % 3 == 0 ? world.sphere(1, 0.05, at) : world.box(BodyMotion::kDynamic, 1 + i, {0.1, 0.1, 0.1}, at, 0.3, 0.3);
  }
  return world;
}

std::vector<std::vector<BodyState>> record(Simulation& run, int steps) {
  std::vector<std::vector<BodyState>> history;
  for (int i = 0; i < steps; ++i) {
    run.step();
    history.push_back(run.states);
  }
  return history;
}

TEST_P(Replay, TwoRunsGiveTheSameBits) {
  Simulation a(GetParam(), pile(), 1e-3), b(GetParam(), pile(), 1e-3);
  const auto first = record(a, 400), second = record(b, 400);
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_TRUE(same_bits(first[i], second[i])) << "step " << i + 1;
}

TEST_P(Replay, RestoredStateRepeatsTheSameBits) {
  Simulation run(GetParam(), pile(), 1e-3);
  record(run, 150);
  std::vector<std::byte> saved;
  run.engine().save(saved);
  const auto first = record(run, 100);
  ASSERT_TRUE(run.engine().restore(saved));
  const auto again = record(run, 100);
  // A fresh engine knows nothing of the history either.
  Simulation fresh(GetParam(), pile(), 1e-3);
  ASSERT_TRUE(fresh.engine().restore(saved));
  const auto elsewhere = record(fresh, 100);
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_TRUE(same_bits(first[i], again[i])) << "same engine, step " << i + 1;
    ASSERT_TRUE(same_bits(first[i], elsewhere[i])) << "fresh engine, step " << i + 1;
  }
}

TEST_P(Replay, JointsReplayToo) {
  World world;
  const auto b = world.box(BodyMotion::kDynamic, 1, {0.1, 0.1, 0.3}, {0, 0, -0.15});
  JointRecord& hinge = world.joint(JointType::kRevolute, -1, b, {0, 0, 0});
  hinge.spring = 0.1;
  hinge.motor_velocity = 8;
  hinge.motor_max_effort = 2;
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  record(run, 900);  // beyond one turn: the count of turns is part of the state
  std::vector<std::byte> saved;
  run.engine().save(saved);
  const auto first = record(run, 200);
  Simulation fresh(GetParam(), world, 1e-3);
  ASSERT_TRUE(fresh.engine().restore(saved));
  const auto again = record(fresh, 200);
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_TRUE(same_bits(first[i], again[i])) << "step " << i + 1;
}

TEST_P(Replay, PosesAndGravityFromOutsideAreInTheState) {
  World world;
  const auto ball = world.sphere(2, 0.05, {0, 0, 5});
  Simulation run(GetParam(), world, 1e-3);
  record(run, 100);
  exchange::Command pose{};
  pose.kind = exchange::CommandKind::kPose, pose.body = static_cast<std::uint32_t>(ball);
  const double place[7] = {1, 2, 3, 0.6, 0, 0.8, 0};
  std::copy_n(place, 7, pose.values);
  exchange::Command gravity{};
  gravity.kind = exchange::CommandKind::kGravity;
  gravity.values[0] = 1.5;
  ASSERT_TRUE(run.engine().obey(pose));
  ASSERT_TRUE(run.engine().obey(gravity));
  std::vector<std::byte> saved;
  run.engine().save(saved);
  const auto first = record(run, 200);
  // The velocity of 0.1 s of fall stays; gravity is 1.5 m/s^2 along x for 0.2 s.
  EXPECT_NEAR(run.position(ball).x(), 1 + 0.5 * 1.5 * 0.2 * 0.2, 1e-9);
  EXPECT_NEAR(run.position(ball).y(), 2, 1e-12);
  EXPECT_NEAR(run.position(ball).z(), 3 - 9.81 * 0.1 * 0.2, 1e-9);
  EXPECT_NEAR(run.states[ball].orientation[2], 0.8, 1e-12);
  std::vector<BodyState> now = run.states;
  run.engine().mobility(now);
  EXPECT_EQ(now[ball].free_acceleration[0], 1.5);
  Simulation fresh(GetParam(), world, 1e-3);
  ASSERT_TRUE(fresh.engine().restore(saved));
  const auto again = record(fresh, 200);
  for (std::size_t i = 0; i < first.size(); ++i) ASSERT_TRUE(same_bits(first[i], again[i])) << "step " << i + 1;
}

TEST_P(Replay, ForeignStateIsRefused) {
  Simulation run(GetParam(), pile(), 1e-3);
  std::vector<std::byte> saved;
  run.engine().save(saved);
  saved.pop_back();
  const auto restored = run.engine().restore(saved);
  ASSERT_FALSE(restored);
  EXPECT_NE(restored.error().what.find("bytes"), std::string::npos);
}

}  // namespace ballast::testing
