// The suite that every engine in the table runs: parameterised over engine_names(). An engine that lacks joints or
// contacts must say so by name; those tests then check the refusal instead of the physics.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/rigid_fixture.h"

namespace ballast::testing {

/// Prints a measured figure beside its target, so that a test log is also a report.
inline void figure(const std::string& what, double value, const std::string& target) {
  std::printf("    %-58s %.4g   (target %s)\n", what.c_str(), value, target.c_str());
}

class EveryEngine : public ::testing::TestWithParam<std::string> {
 protected:
  /// True if the engine takes joints; otherwise checks that it refuses this world with exit code 2, naming joint and
  /// engine.
  bool takes_joints(const World& world) const {
    auto engine = make_engine(GetParam());
    const auto loaded = (*engine)->load(world.manifest.view());
    if (loaded) return true;
    EXPECT_EQ(loaded.error().exit_code, kBadInput);
    EXPECT_NE(loaded.error().what.find(GetParam()), std::string::npos) << loaded.error().what;
    EXPECT_NE(loaded.error().what.find(world.manifest.joints[0].name), std::string::npos) << loaded.error().what;
    return false;
  }
  /// True if the engine has contacts; otherwise checks that it says so in the line for the run record and that a body
  /// falls through a floor as if the floor were not there.
  bool has_contacts() const {
    auto engine = make_engine(GetParam());
    if ((*engine)->describe().find("no contacts") == std::string::npos) return true;
    World world;
    const auto ball = world.sphere(1, 0.05, {0, 0, 0.2});
    world.plane({0, 0, 1});
    Simulation run(GetParam(), world, 1e-3);
    run.to(1);
    EXPECT_NEAR(run.position(ball).z(), 0.2 - 0.5 * 9.81, 1e-9);
    return false;
  }
};

inline std::string engine_name(const ::testing::TestParamInfo<std::string>& info) { return info.param; }

}  // namespace ballast::testing

#define FOR_EVERY_ENGINE(suite) \
  INSTANTIATE_TEST_SUITE_P(Engines, suite, ::testing::ValuesIn(ballast::engine_names()), ballast::testing::engine_name)
