// The progress line holds error beside run time, and fits.
#include "launch/progress.h"

#include <gmock/gmock.h>

namespace ballast::launch {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

ProgressState half_way() {
  ProgressState s;
  s.time = 0.5;
  s.duration = 1;
  s.dt = 4e-4;
  s.wall = 30;
  s.limit = "sound";
  s.steps = 1250;
  s.particles = 10648;
  return s;
}

/// Of a coupled run with an implicit solver: all there are.
LiveErrors all_errors() {
  return {.density_mean = 0.0031,
          .density_max = 0.2,
          .pressure = 2e-4,
          .interface = 0.013,
          .mass = -0.00125,
          .momentum = 2.4e-16,
          .energy = 0.0002};
}

TEST(ProgressLine, HasErrorsBesideWallTime) {
  ProgressState s = half_way();
  s.errors = {.density_mean = 0.0031, .mass = 0.0, .momentum = 2.4e-16, .energy = 0.012};
  EXPECT_EQ(progress_text(s),
            " 50 %  0.500/1 s  wall 30 s, 30 s left  density 0.31 %  mass 0  energy +1.2 %  momentum 2e-16");
}

TEST(ProgressLine, LeavesOutWhatARunDoesNotHave) {
  ProgressState s = half_way();
  s.errors = {.density_mean = 0.0031, .mass = 0.0};
  const std::string fluid_alone = progress_text(s);
  EXPECT_THAT(fluid_alone, HasSubstr("density 0.31 %  mass 0  "));
  for (const char* name : {"pressure", "interface", "momentum", "energy"})
    EXPECT_THAT(fluid_alone, Not(HasSubstr(name))) << name;
  s.errors = {};
  s.particles = 0;
  s.limit = "";
  EXPECT_EQ(progress_text(s), " 50 %  0.500/1 s  wall 30 s, 30 s left  0.0167 x real time  step 0.4 ms");
}

TEST(ProgressLine, IsNeverWiderThanAsked) {
  ProgressState s = half_way();
  s.errors = all_errors();
  s.time = 12345.678;
  s.duration = 99999.5;
  s.wall = 7654321;
  for (std::size_t columns = 5; columns <= 200; ++columns)
    EXPECT_LE(progress_text(s, columns).size(), columns) << progress_text(s, columns);
  EXPECT_LE(progress_text(s).size(), 100u);
}

/// 79: what a terminal of 80 columns gives.
TEST(ProgressLine, DropsErrorsLastAndThoseAtRoundingLevelFirst) {
  ProgressState s = half_way();
  s.errors = all_errors();
  s.errors.pressure = {};
  s.errors.mass = 0;
  s.errors.energy = 0;
  EXPECT_EQ(progress_text(s, 79), " 50 %  wall 30 s, 30 s left  density 0.31 %  mass 0  energy 0  interface 1.3 %");
  s.errors.momentum = 0.02;  // no rounding error: this one must be seen
  EXPECT_EQ(progress_text(s, 79), " 50 %  wall 30 s, 30 s left  density 0.31 %  momentum 2.0 %  interface 1.3 %");
  EXPECT_EQ(progress_text(s, 40), " 50 %  wall 30 s, 30 s left") << "no figure of less use in place of another";
  EXPECT_EQ(
      progress_text(s, 200),
      " 50 %  0.500/1 s  wall 30 s, 30 s left  density 0.31 %  mass 0  energy 0  momentum 2.0 %  interface 1.3 %  "
      "0.0167 x real time  step 0.4 ms (sound)  10648 particles");
}

TEST(ProgressLine, HasShortFiguresOfEverySize) {
  ProgressState s = half_way();
  const auto density = [&](double error) {
    s.errors = {.density_mean = error};
    const std::string line = progress_text(s, 48);
    return line.substr(line.find("density ") + 8);
  };
  EXPECT_THAT(density(1.66), StartsWith("166 %"));
  EXPECT_THAT(density(0.0996), StartsWith("10 %"));
  EXPECT_THAT(density(0.096), StartsWith("9.6 %"));
  EXPECT_THAT(density(0.00996), StartsWith("1.0 %"));
  EXPECT_THAT(density(0.001), StartsWith("0.10 %"));
  EXPECT_THAT(density(0.0001), StartsWith("0.01 %"));
  EXPECT_THAT(density(0.00009), StartsWith("9e-5"));
  EXPECT_THAT(density(1e-12), StartsWith("1e-12"));
  EXPECT_THAT(density(0), StartsWith("0"));
}

TEST(ProgressLine, SaysThatARunPrepares) {
  ProgressState s = half_way();
  s.steps = 0;
  s.time = 0;
  EXPECT_EQ(progress_text(s), "  0 %  0.000/1 s  preparing, 30 s");
}

}  // namespace
}  // namespace ballast::launch
