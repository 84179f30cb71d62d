// Credit: never shrinks, never starves the processes, is renewed seldom.
#include "launch/schedule.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace ballast::launch {
namespace {

TEST(Schedule, GrantsTheWholeRunAheadAtTheStart) { EXPECT_EQ(next_credit(0, 0, 100), 100u); }

TEST(Schedule, WaitsUntilHalfIsUsed) {
  EXPECT_FALSE(next_credit(100, 49, 100));
  EXPECT_EQ(next_credit(100, 50, 100), 150u);
}

TEST(Schedule, GrantsAtOnceWhenAllIsUsed) {
  EXPECT_EQ(next_credit(1, 1, 1), 2u);
  EXPECT_EQ(next_credit(1, 1, 0), 2u);  // less than one step ahead would stop the run
}

TEST(Schedule, NeverLetsStepsRunFurtherThanAskedAndNeverStarves) {
  for (std::uint64_t ahead : {1u, 2u, 3u, 7u, 64u}) {
    std::uint64_t granted = 0, grants = 0;
    for (std::uint64_t reported = 0; reported < 1000; ++reported) {
      if (const auto credit = next_credit(granted, reported, ahead)) {
        ASSERT_GT(*credit, granted);
        granted = *credit;
        ++grants;
      }
      ASSERT_GT(granted, reported);  // the next step may begin
      ASSERT_LE(granted, reported + ahead);
    }
    EXPECT_LE(grants, 1000 / std::max<std::uint64_t>(1, ahead / 2) + 2);
  }
}

}  // namespace
}  // namespace ballast::launch
