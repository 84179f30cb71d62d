// Bodies released at rest in a concentric container, from a hundredth to eight times as dense as the water, by both
// coupling schemes, side by side. The staggered scheme hands on the last step's acceleration and must blow up where the
// water to be moved weighs much more than the body: that proves that the case has power.
#include <cmath>
#include <string>
#include <vector>

#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

struct AddedMass : ::testing::TestWithParam<std::pair<const char*, double>> {
  Scratch scratch;

  /// Relative error of the first acceleration; infinite where the run diverged. `more`: further arguments.
  double error(double ratio, const char* scheme, const std::vector<std::string>& more, double exact, int& code) {
    std::vector<std::string> arguments = {scene(GetParam().first),
                                          "--quiet",
                                          "--scheme",
                                          scheme,
                                          "--set",
                                          "models.body.density=" + std::to_string(1000 * ratio)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Command run(scratch.path, arguments);
    code = run.wait();
    if (code == 4) return std::numeric_limits<double>::infinity();
    const nlohmann::json record = run.record();
    for (const auto& verdict : record["expect"])
      if (verdict["name"] == "initial acceleration of body")
        return verdict["value"].is_number() ? verdict["value"].get<double>() / exact - 1
                                            : std::numeric_limits<double>::infinity();
    ADD_FAILURE() << "the record does not name the acceleration\n" << run.text();
    return 0;
  }
};

TEST_P(AddedMass, InterlinkedIsRightAtEveryDensityWhereStaggeredBlowsUpAtLightOnes) {
  const double coefficient = GetParam().second;  // of added mass
  std::printf("%-14s %12s %12s %12s\n", "density ratio", "exact, m/s^2", "interlinked", "staggered");
  for (double ratio : {0.01, 0.1, 0.5, 0.9, 1.1, 2.0, 8.0}) {
    const double exact = 9.81 * (ratio - 1) / (ratio + coefficient);
    int code = -1, staggered_code = -1;
    const double interlinked = error(ratio, "interlinked", {}, exact, code);  // all that the scene asks
    const double staggered = error(ratio, "staggered", {"--duration", "25ms"}, exact, staggered_code);
    std::printf("%-14g %12.4f %10.2f %% %10.4g %%\n", ratio, exact, 100 * interlinked, 100 * staggered);
    std::fflush(stdout);
    EXPECT_EQ(code, 0) << ratio;  // every expectation of the scene
    EXPECT_LE(std::abs(interlinked), 0.04) << ratio;
    if (ratio >= 0.5) {
      EXPECT_LE(std::abs(staggered), 0.04) << ratio;
    }
    if (ratio <= 0.01) {
      EXPECT_GT(std::abs(staggered), 1) << ratio;
    }
  }
}

// Radius ratio q = 2: cylinder (q^2 + 1) / (q^2 - 1) (Lamb, art. 93), sphere (q^3 + 2) / 2 (q^3 - 1) (art. 92).
INSTANTIATE_TEST_SUITE_P(Scenes, AddedMass,
                         ::testing::Values(std::pair("added_mass_2d", 5.0 / 3), std::pair("added_mass_3d", 10.0 / 14)),
                         [](const auto& each) { return std::string(each.param.first); });

}  // namespace
}  // namespace ballast::testing
