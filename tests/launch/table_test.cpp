// Statistics of rows over time against values worked out by hand.
#include "launch/table.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ballast::launch {
namespace {

Table parabola() {
  Table table{{"a", "b"}, {}, {}};
  for (int i = 0; i <= 4; ++i) table.add(i, std::vector<double>{static_cast<double>(i * i), -2.0 * i + 3});
  return table;  // a: 0 1 4 9 16; b: 3 1 -1 -3 -5
}

TEST(Table, RefusesARowOfTheWrongLength) {
  Table table{{"a", "b"}, {}, {}};
  EXPECT_FALSE(table.add(0, std::vector<double>{1}));
  EXPECT_EQ(table.rows(), 0u);
}

TEST(Table, FindsColumnsByExactName) {
  EXPECT_EQ(parabola().column("b"), 1u);
  EXPECT_FALSE(parabola().column("B"));
}

TEST(Statistic, MatchesHandComputedValues) {
  const Series a = window(parabola(), 0, 0, 1e300);
  EXPECT_DOUBLE_EQ(statistic(a, "last"), 16);
  EXPECT_DOUBLE_EQ(statistic(a, "mean"), 6);
  EXPECT_DOUBLE_EQ(statistic(a, "min"), 0);
  EXPECT_DOUBLE_EQ(statistic(a, "max"), 16);
  EXPECT_DOUBLE_EQ(statistic(a, "change"), 16);
  EXPECT_DOUBLE_EQ(statistic(a, "rms"), std::sqrt((36.0 + 25 + 4 + 9 + 100) / 5));
  EXPECT_DOUBLE_EQ(statistic(window(parabola(), 1, 0, 9), "max_abs"), 5);
  EXPECT_DOUBLE_EQ(statistic(window(parabola(), 1, 0, 9), "slope"), -2);
}

TEST(Statistic, IsNotANumberWithoutRowsOrForAnUnknownName) {
  EXPECT_TRUE(std::isnan(statistic({}, "last")));
  EXPECT_TRUE(std::isnan(statistic(window(parabola(), 0, 0, 9), "median")));
  EXPECT_TRUE(std::isnan(slope(window(parabola(), 0, 2, 2))));
}

TEST(Window, KeepsRowsAtItsEndsDespiteRounding) {
  Table table{{"a"}, {}, {}};
  table.add(0.1 + 0.2, std::vector<double>{7});  // 0.30000000000000004
  EXPECT_EQ(window(table, 0, 0, 0.3).values.size(), 1u);
  EXPECT_EQ(window(table, 0, 0.31, 1).values.size(), 0u);
}

TEST(Interpolate, IsLinearBetweenRowsAndNothingOutside) {
  const Series a = window(parabola(), 0, 0, 9);
  EXPECT_DOUBLE_EQ(*interpolate(a, 2.5), 6.5);
  EXPECT_DOUBLE_EQ(*interpolate(a, 0), 0);
  EXPECT_DOUBLE_EQ(*interpolate(a, 4), 16);
  EXPECT_FALSE(interpolate(a, 4.01));
  EXPECT_FALSE(interpolate(a, -0.01));
}

}  // namespace
}  // namespace ballast::launch
