// The quasi-Newton iteration on problems whose solution is known and where plain iteration diverges.
#include "fluid_server/step/quasi_newton.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>

namespace ballast::fluid {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Map = std::function<VectorXd(const VectorXd&)>;

/// x -> A x + b with the fixed point `solution`. A has the eigenvalues of bodies much lighter than the water they move,
/// -added mass / mass, in a basis that mixes the unknowns.
struct Linear {
  explicit Linear(const VectorXd& eigenvalues, const VectorXd& at) : solution(at) {
    MatrixXd mixed(at.size(), at.size());
    for (Eigen::Index i = 0; i < at.size(); ++i)
      for (Eigen::Index j = 0; j < at.size(); ++j) mixed(i, j) = std::sin(1.0 + 3.0 * double(i) + 7.0 * double(i * j));
    const MatrixXd basis = mixed.householderQr().householderQ();
    a = basis * eigenvalues.asDiagonal() * basis.transpose();
  }
  VectorXd operator()(const VectorXd& x) const { return a * (x - solution) + solution; }
  MatrixXd a;
  VectorXd solution;
};

/// Iterations until the residual is below `tolerance`; -1 if it is not after `most`.
int iterations(QuasiNewton& solver, const Map& map, VectorXd& x, double tolerance, int most = 50) {
  solver.begin();
  for (int k = 1; k <= most; ++k) {
    const VectorXd residual = map(x) - x;
    if (residual.norm() <= tolerance) return k;
    x = solver.next(x, residual);
  }
  return -1;
}

const VectorXd kLight = (VectorXd(6) << -100, -60, -50, -8, -3, -0.5).finished();
const VectorXd kSolution = (VectorXd(6) << 1, -2, 3, 0.5, 9, -4).finished();

TEST(QuasiNewton, SolvesALinearProblemInHardlyMoreIterationsThanUnknownsWherePlainIterationDiverges) {
  const Linear map(kLight, kSolution);
  VectorXd plain = VectorXd::Zero(6);
  for (int k = 0; k < 10; ++k) plain = map(plain);
  ASSERT_GT((plain - kSolution).norm(), 1e10) << "the problem is too easy";
  QuasiNewton solver;
  VectorXd x = VectorXd::Zero(6);
  const int taken = iterations(solver, map, x, 1e-7);
  EXPECT_GT(taken, 0);
  EXPECT_LE(taken, 6 + 3);  // one more where a column is left out, one to see that it is solved
  EXPECT_LT((x - kSolution).norm(), 1e-6);
}

/// Twelve unknowns of which all hang on one: columns that are multiples of each other must not spoil the least squares.
TEST(QuasiNewton, DependentColumnsAreLeftOut) {
  const VectorXd direction = VectorXd::Ones(12).normalized(), solution = VectorXd::LinSpaced(12, 1, 2);
  const Map map = [&](const VectorXd& x) { return VectorXd(solution - 40 * direction * direction.dot(x - solution)); };
  QuasiNewton solver;
  VectorXd x = VectorXd::Zero(12);
  const int taken = iterations(solver, map, x, 1e-9);
  EXPECT_GT(taken, 0);
  EXPECT_LE(taken, 4);
  EXPECT_LT((x - solution).norm(), 1e-8);
}

/// A contact that bears no tension: the map has a kink, and its steep side would make plain iteration diverge.
TEST(QuasiNewton, AKinkIsGotOver) {
  for (const double start : {-10.0, -1.0, 0.5, 1.0, 5.0, 20.0}) {
    const Map map = [](const VectorXd& x) { return VectorXd::Constant(1, x[0] < 1 ? 2 - 5 * (x[0] - 1) : 2.0).eval(); };
    QuasiNewton solver;
    VectorXd x = VectorXd::Constant(1, start);
    EXPECT_GT(iterations(solver, map, x, 1e-9), 0) << start;
    EXPECT_NEAR(x[0], 2, 1e-9);
  }
}

}  // namespace
}  // namespace ballast::fluid
