// Light bodies that joints bind, released in water, by coupling schemes and solvers side by side. The fluid cannot
// foresee what a joint bears: the iterated scheme must find it, the interlinked one at least in its first step, and the
// staggered one blow up where the water to be moved weighs much more than the body. Formulas: Lamb, art. 93.
#include <cmath>

#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

struct Joined : ::testing::Test {
  Scratch scratch;

  /// Relative error of the mean that the first expectation on a column found; infinite where the run diverged.
  double error(const std::string& file, const char* solver, const char* scheme, double exact) {
    Command run(scratch.path,
                {file, "--quiet", "--scheme", scheme, "--set", std::string("numerics.pressure=") + solver});
    const int code = run.wait();
    if (code == 4) return std::numeric_limits<double>::infinity();
    const nlohmann::json record = run.record();
    EXPECT_LE(record["ledger"]["imbalance_relative"], 1e-12) << "steps that were taken back are in the ledger";
    double value = NAN;
    for (const auto& verdict : record["expect"])
      if (verdict["name"].get<std::string>().find("az") != std::string::npos) value = verdict["value"];
    const double found = value / exact - 1;
    std::printf("%-10s %-12s %8.2f %%, residual %.2g\n", solver, scheme, 100 * found,
                record["error"]["interface_residual_mean"].get<double>());
    std::fflush(stdout);
    return found;
  }
};

TEST_F(Joined, CylindersOnOneRodFallWithTheAddedMassOfBoth) {
  const std::string file = scene("joined_cylinders");
  const double exact = -9.81 * (4010 - 2000) / (4010 + 2 * 1000 * 5.0 / 3);
  EXPECT_LE(std::abs(error(file, "implicit", "iterated", exact)), 0.04);
  EXPECT_LE(std::abs(error(file, "implicit", "interlinked", exact)), 0.04) << "wrong by 87 % without a settled start";
  EXPECT_LE(std::abs(error(file, "wcsph", "iterated", exact)), 0.04);
}

/// A hundredth of the water's density, on a rail at 45 degrees.
TEST_F(Joined, ALightCylinderOnARailIsRightWhereTheStaggeredSchemeBlowsUp) {
  const fs::path file = scratch.path / "rail.yaml";
  std::ofstream(file) << R"(ballast: 1
world: { dimension: 2, duration: 20 ms, spacing: 1 cm }
numerics: { reduced_gravity: true }
fluids:
  - { name: water, material: water, viscosity: 0, fill: { level: { container: shell, z: 0.2 } } }
models:
  - { name: shell, static: true, shape: { hollow_cylinder: { radius: 0.2, length: 1, wall: 0.05 } } }
  - { name: body, shape: { cylinder: { radius: 0.1, length: 1 } }, density: 10 }
joints:
  - { name: rail, type: prismatic, parent: world, child: body, axis: [0.70710678118654752, 0, 0.70710678118654752] }
output: { every: 2 ms }
expect:
  - { column: { of: body.az, statistic: mean, from: 2 ms, above: 0 } }
)";
  const double exact = 0.5 * 9.81 * (1000 - 10) / (10 + 1000 * 5.0 / 3);
  for (const char* solver : {"wcsph", "implicit"})
    EXPECT_LE(std::abs(error(file, solver, "iterated", exact)), 0.04) << solver;
  EXPECT_GT(std::abs(error(file, "wcsph", "staggered", exact)), 1);
}

}  // namespace
}  // namespace ballast::testing
