// When a run may sleep: bounds and times worked out by hand.
#include "common/exchange/sleep.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ballast::exchange {
namespace {

/// A free box of 6 x 8 x 0 m, whose corners are 5 m from its centre; at rest below 0.1 m/s for 1 s; rows every 0.5 s.
struct Sleeping : ::testing::Test {
  Manifest manifest;
  std::vector<BodyState> states{BodyState{}};

  void SetUp() override {
    manifest.world.sleep_speed = 0.1;
    manifest.world.sleep_after = 1;
    manifest.world.output_every = 0.5;
    manifest.bodies.push_back({});
    manifest.bodies[0].motion = BodyMotion::kDynamic;
    manifest.shapes.push_back({});
    manifest.shapes[0].type = ShapeType::kBox;
    manifest.shapes[0].size[0] = 6, manifest.shapes[0].size[1] = 8;
  }
  Sleep make() const { return Sleep(manifest.view()); }
  /// A run that is computed up to `end` in steps of 0.1 s, with a fluid of this speed.
  Sleep at_rest(double end, double fluid = 0) {
    Sleep sleep = make();
    for (int k = 1; k <= std::lround(end * 10); ++k) sleep.computed(0.1 * k, states, fluid);
    return sleep;
  }
  void drive(double start, double stop) {
    BodyRecord& body = manifest.bodies.emplace_back();
    body.motion = BodyMotion::kPrescribed;
    body.drive_velocity[2] = 1;
    body.drive_start = start, body.drive_stop = stop;
    states.push_back({});
  }
};

TEST_F(Sleeping, BeginsAfterTheTimeAtRestAndLastsToTheNextRow) {
  EXPECT_EQ(at_rest(0.9).until(0.9), 0.9);
  EXPECT_EQ(at_rest(1.1).until(1.1), 1.5);
  EXPECT_EQ(at_rest(1.5).until(1.5), 2.0) << "on a row: to the one after it";
}

TEST_F(Sleeping, NeverBeginsWhereItIsNotAskedFor) {
  manifest.world.sleep_speed = 0;
  EXPECT_FALSE(make().possible());
  EXPECT_EQ(at_rest(100).until(100), 100);
}

TEST_F(Sleeping, CountsTheFastestPointOfABodyThatTurns) {
  states[0].angular_velocity[2] = 0.019;  // 5 m * 0.019 / s = 0.095 m/s
  EXPECT_GT(at_rest(1.2).until(1.2), 1.2);
  states[0].angular_velocity[2] = 0.021;
  EXPECT_EQ(at_rest(1.2).until(1.2), 1.2);
}

TEST_F(Sleeping, WaitsForBodiesAndFluidAlike) {
  EXPECT_EQ(at_rest(2, 0.11).until(2), 2);
  EXPECT_EQ(at_rest(2, std::nan("")).until(2), 2) << "what is not a number is not at rest";
  states[0].velocity[0] = 0.11;
  EXPECT_EQ(at_rest(2).until(2), 2);
}

TEST_F(Sleeping, StartsTheClockAnewAfterEveryQuickMove) {
  Sleep sleep = at_rest(5);
  sleep.computed(5.1, states, 0.2);
  sleep.computed(6.0, states, 0);
  EXPECT_EQ(sleep.until(6.0), 6.0) << "0.9 s at rest";
  sleep.computed(6.2, states, 0);
  EXPECT_EQ(sleep.until(6.2), 6.5);
}

TEST_F(Sleeping, EndsBeforeAPrescribedBodyBeginsToMoveAndComesBackWhenItHasStopped) {
  drive(1.2, 3);
  EXPECT_EQ(at_rest(1.1).until(1.1), 1.2);
  EXPECT_EQ(at_rest(1.2).until(1.2), 1.2);
  EXPECT_EQ(at_rest(2.9).until(2.9), 2.9) << "states that lag behind do not matter: it is being moved";
  EXPECT_EQ(at_rest(3).until(3), 3.5);
}

TEST_F(Sleeping, IsBrokenByCommandsAndByWrenchesAsLongAsTheyAct) {
  Sleep sleep = at_rest(2);
  Command command{};
  command.kind = CommandKind::kGravity;
  sleep.command(command, 2);
  EXPECT_EQ(sleep.until(2.9), 2.9);
  EXPECT_EQ(sleep.until(3.1), 3.5);
  command.kind = CommandKind::kWrench;
  command.duration = 4;
  sleep.command(command, 3.5);
  EXPECT_EQ(sleep.until(7.4), 7.4) << "pushed until 7.5 s";
  EXPECT_EQ(sleep.until(7.6), 8.0);
}

TEST_F(Sleeping, IsRefusedByAMotorWithItsName) {
  JointRecord& joint = manifest.joints.emplace_back();
  std::snprintf(joint.name, sizeof joint.name, "winch");
  joint.motor_max_effort = 5;
  EXPECT_TRUE(make().possible()) << "a motor that holds is a brake";
  joint.motor_velocity = 1e-3;
  EXPECT_FALSE(make().possible());
  EXPECT_NE(make().awake_because().find("'winch'"), std::string::npos);
  EXPECT_EQ(at_rest(9).until(9), 9);
}

TEST_F(Sleeping, AddsUpItsNapsAndWhatTheyMayHaveChanged) {
  states[0].velocity[0] = 0.02;
  Sleep sleep = at_rest(2);
  sleep.slept(2, 2.5);
  sleep.slept(2.5, 3);
  sleep.computed(3.1, states, 0.05);
  sleep.slept(3.1, 3.5);
  EXPECT_EQ(sleep.naps().size(), 2u);
  EXPECT_EQ(sleep.steps(), 3u);
  EXPECT_DOUBLE_EQ(sleep.seconds(), 1.4);
  EXPECT_DOUBLE_EQ(sleep.bound(), 1.4 * 0.1);
  EXPECT_DOUBLE_EQ(sleep.drift(), 1 * 0.02 + 0.4 * 0.05);
}

TEST_F(Sleeping, CountsWhatItSavedAtThePaceOfTheStepsComputed) {
  Sleep sleep = at_rest(2);
  sleep.took(3.0, 2);  // 1.5 s of wall time per simulated second
  sleep.slept(2, 4);
  sleep.took(0.1, 2);
  EXPECT_DOUBLE_EQ(sleep.saved(), 2 * 1.5 - 0.1);
}

}  // namespace
}  // namespace ballast::exchange
