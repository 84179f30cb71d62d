// The two processes must speak of the same step and the same bodies.
#include "launch/lockstep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace ballast::launch {
namespace {

using exchange::Role;
using exchange::StepReport;

StepReport report(std::uint64_t step, std::uint64_t hash) {
  StepReport out{};
  out.step = step;
  out.hash = hash;
  return out;
}

TEST(Lockstep, CountsAStepWhenBothHaveReportedIt) {
  Lockstep lockstep(true);
  EXPECT_TRUE(lockstep.take(Role::kFluid, report(1, 7)));
  EXPECT_TRUE(lockstep.take(Role::kFluid, report(2, 8)));
  EXPECT_EQ(lockstep.reported(), 0u);
  EXPECT_TRUE(lockstep.take(Role::kRigid, report(1, 7)));
  EXPECT_EQ(lockstep.reported(), 1u);
  EXPECT_TRUE(lockstep.take(Role::kRigid, report(2, 8)));
  EXPECT_EQ(lockstep.reported(), 2u);
}

TEST(Lockstep, RefusesDifferentBodiesWithTheStepInTheMessage) {
  Lockstep lockstep(true);
  ASSERT_TRUE(lockstep.take(Role::kFluid, report(41, 7)));
  const Status status = lockstep.take(Role::kRigid, report(41, 6));
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().exit_code, kProcessFailed);
  EXPECT_NE(status.error().what.find("step 41"), std::string::npos);
}

TEST(Lockstep, RefusesDifferentSteps) {
  Lockstep lockstep(true);
  ASSERT_TRUE(lockstep.take(Role::kFluid, report(2, 7)));
  EXPECT_FALSE(lockstep.take(Role::kRigid, report(1, 7)));
}

TEST(Lockstep, BalancesTheMomentumOfTheSameStep) {
  Lockstep lockstep(true);
  const auto take = [&](Role role, std::uint64_t step, std::array<double, 3> impulse, double scale) {
    StepReport out = report(step, 7);
    std::ranges::copy(impulse, out.impulse);
    out.impulse_scale = scale;
    EXPECT_TRUE(lockstep.take(role, out));
  };
  take(Role::kFluid, 1, {4, 4, 1}, 10);
  take(Role::kFluid, 2, {90, 0, 0}, 100);
  EXPECT_FALSE(lockstep.imbalance());
  take(Role::kRigid, 1, {1, 0, 1}, 99);
  EXPECT_DOUBLE_EQ(*lockstep.imbalance(), 0.5);  // |(3, 4, 0)| / 10
  take(Role::kRigid, 2, {90, 0, 0}, 99);
  EXPECT_EQ(lockstep.imbalance(), 0.0);
}

TEST(Lockstep, OfOneProcessHasNothingToCompare) {
  Lockstep lockstep(false);
  EXPECT_TRUE(lockstep.take(Role::kRigid, report(5, 7)));
  EXPECT_EQ(lockstep.reported(), 5u);
  EXPECT_FALSE(lockstep.imbalance());
}

}  // namespace
}  // namespace ballast::launch
