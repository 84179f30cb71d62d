// MPRGP against the solution found by trying every set of clamped entries.
#include "fluid_server/pressure/mprgp.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace ballast::fluid {
namespace {

/// A dense problem, preconditioned by its diagonal.
class Dense : public QuadraticProgram {
 public:
  Dense(Eigen::MatrixXd a, double tolerance, double negligible = -1)
      : a_(std::move(a)), tolerance_(tolerance), negligible_(negligible) {}
  void multiply(std::span<const float> x, std::vector<float>& out) override {
    const Eigen::VectorXd y = a_ * vector(x);
    out.assign(x.size(), 0.f);
    for (std::size_t i = 0; i < x.size(); ++i) out[i] = static_cast<float>(y[static_cast<int>(i)]);
  }
  void precondition(std::span<const float> r, std::vector<float>& out) override {
    for (std::size_t i = 0; i < r.size(); ++i)
      out[i] = r[i] / static_cast<float>(a_(static_cast<int>(i), static_cast<int>(i)));
  }
  bool negligible(double beyond) const override { return beyond <= negligible_; }
  bool harmless(std::span<const float> cut) override {
    return !exact_end || std::all_of(cut.begin(), cut.end(), [](float one) { return one == 0; });
  }
  bool good(std::span<const float>, std::span<const float> gradient) override {
    return vector(gradient).norm() < tolerance_;
  }
  bool exact_end = false;  ///< nothing may be cut off at the end without a gradient
  static Eigen::VectorXd vector(std::span<const float> x) {
    return Eigen::Map<const Eigen::VectorXf>(x.data(), static_cast<int>(x.size())).cast<double>();
  }

 private:
  Eigen::MatrixXd a_;
  double tolerance_, negligible_;
};

double energy(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, const Eigen::VectorXd& x) {
  return 0.5 * x.dot(a * x) - b.dot(x);
}

/// The minimiser over x_i >= 0 for bounded i: for every set of entries clamped at zero, the free minimiser; the best
/// feasible one.
Eigen::VectorXd by_brute_force(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                               const std::vector<std::uint8_t>& bounded) {
  const int n = static_cast<int>(b.size());
  Eigen::VectorXd best = Eigen::VectorXd::Zero(n);
  double least = std::numeric_limits<double>::infinity();
  for (int set = 0; set < 1 << n; ++set) {
    std::vector<int> free;
    bool allowed = true;
    for (int i = 0; i < n; ++i) {
      if (set >> i & 1)
        allowed &= bounded[static_cast<std::size_t>(i)] != 0;
      else
        free.push_back(i);
    }
    if (!allowed) continue;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    if (!free.empty()) {
      const Eigen::MatrixXd part = a(free, free);
      const Eigen::VectorXd right = b(free);
      x(free) = part.ldlt().solve(right).eval();
    }
    for (int i = 0; i < n; ++i) allowed &= !bounded[static_cast<std::size_t>(i)] || x[i] >= -1e-12;
    if (allowed && energy(a, b, x) < least) least = energy(a, b, x), best = x;
  }
  return best;
}

struct Case {
  int size;
  unsigned seed;
  double light;  // strength of a rank-one part: a light body
};

class Random : public ::testing::TestWithParam<Case> {};

TEST_P(Random, GivesTheMinimiser) {
  const auto [n, seed, light] = GetParam();
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(n, n);
  Eigen::VectorXd b(n), w(n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) root(i, j) = normal(random);
    b[i] = normal(random), w[i] = normal(random);
  }
  const Eigen::MatrixXd a = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n) + light * w * w.transpose();
  std::vector<std::uint8_t> bounded(static_cast<std::size_t>(n));
  for (auto& one : bounded) one = random() % 4 != 0;
  std::vector<float> diagonal, right, x(static_cast<std::size_t>(n), 1.f);
  for (int i = 0; i < n; ++i)
    diagonal.push_back(static_cast<float>(a(i, i))), right.push_back(static_cast<float>(b[i]));
  const Eigen::MatrixXd scaled =
      a.diagonal().cwiseSqrt().cwiseInverse().asDiagonal() * a * a.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
  const double norm = scaled.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff();
  Dense program(a, 1e-5);
  Mprgp mprgp;
  const MprgpReport report = mprgp.solve(program, diagonal, right, bounded, x, norm, 5000, 1);
  EXPECT_TRUE(report.converged) << report.products << " products";
  const Eigen::VectorXd exact = by_brute_force(a, b, bounded), found = Dense::vector(x);
  EXPECT_LE(energy(a, b, found), energy(a, b, exact) + 1e-5);
  for (int i = 0; i < n; ++i) {
    if (bounded[static_cast<std::size_t>(i)]) {
      EXPECT_GE(found[i], 0);
    }
    EXPECT_NEAR(found[i], exact[i], 1e-3 * (1 + exact.norm()));
  }
}

std::vector<Case> cases() {
  std::vector<Case> out;
  for (int n : {1, 2, 5, 12})
    for (unsigned seed = 1; seed <= 8; ++seed) out.push_back({n, seed, seed % 2 ? 0.0 : 100.0});
  return out;
}
INSTANTIATE_TEST_SUITE_P(Sizes, Random, ::testing::ValuesIn(cases()));

TEST(Mprgp, AProductLimitIsReportedAsUnreached) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(3, 3);
  std::vector<float> diagonal(3, 1.f), right(3, 1.f), x(3, 0.f);
  const std::vector<std::uint8_t> bounded(3, 1);
  Dense never(a, -1);
  EXPECT_FALSE(Mprgp().solve(never, diagonal, right, bounded, x, 1, 7, 1).converged);
}

/// A membrane over an obstacle, pushed up and down at random: entries that leave their bounds by little on the way cost
/// no products of their own, and are at them in the end.
TEST(Mprgp, WhatIsNegligibleIsCutOffAtTheEnd) {
  constexpr int kSide = 24, kSize = kSide * kSide;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    a(i, i) = 4;
    if (i % kSide > 0) a(i, i - 1) = a(i - 1, i) = -1;
    if (i >= kSide) a(i, i - kSide) = a(i - kSide, i) = -1;
  }
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<float> right(kSize);
  for (float& one : right) one = normal(random);
  const std::vector<float> diagonal(kSize, 4.f);
  const std::vector<std::uint8_t> bounded(kSize, 1);
  const double tolerance = 1e-2 * Dense::vector(right).norm();
  std::vector<float> exact(kSize, 0.f), strict = exact, easy = exact;
  Dense to_the_end(a, 1e-3 * tolerance), at_once(a, tolerance), later(a, tolerance, tolerance);
  Mprgp mprgp;
  ASSERT_TRUE(mprgp.solve(to_the_end, diagonal, right, bounded, exact, 2, 5000, 1).converged);
  const MprgpReport cut_at_once = mprgp.solve(at_once, diagonal, right, bounded, strict, 2, 5000, 1);
  const MprgpReport cut_at_the_end = mprgp.solve(later, diagonal, right, bounded, easy, 2, 5000, 1);
  ASSERT_TRUE(cut_at_once.converged && cut_at_the_end.converged);
  EXPECT_LT(cut_at_the_end.products, cut_at_once.products);
  const Eigen::VectorXd b = Dense::vector(right), x = Dense::vector(easy), best = Dense::vector(exact);
  EXPECT_GE(x.minCoeff(), 0);
  // What is left is the size of the tolerance: of the gradient, and of what was cut off at the end.
  const Eigen::VectorXd gradient = a * x - b;
  double left = 0;
  for (int i = 0; i < kSize; ++i) left += std::pow(x[i] > 0 ? gradient[i] : std::min(gradient[i], 0.0), 2);
  EXPECT_LT(std::sqrt(left), 3 * tolerance);
  EXPECT_LT((x - best).norm(), 0.05 * best.norm());

  later.exact_end = true;
  std::vector<float> again(kSize, 0.f);
  ASSERT_TRUE(mprgp.solve(later, diagonal, right, bounded, again, 2, 5000, 1).converged);
  const Eigen::VectorXd end = Dense::vector(again);
  EXPECT_GE(end.minCoeff(), 0);
  EXPECT_LT((a * end - b - Dense::vector(mprgp.gradient())).norm(), 1e-5 * b.norm());
}

}  // namespace
}  // namespace ballast::fluid
