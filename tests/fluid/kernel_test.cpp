// Kernels against their definitions (unit integral, slope as the derivative of the value), and slopes over the lattice
// of the particles against fields whose gradient and Laplacian are known.
#include "fluid_server/kernel.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <utility>
#include <vector>

namespace ballast::fluid {
namespace {

struct KernelCase {
  KernelKind kind;
  int dimension;
};

class Kernels : public ::testing::TestWithParam<KernelCase> {
 protected:
  static constexpr double kSpacing = 0.02;
  Kernel kernel_ = Kernel::of(GetParam().kind, GetParam().dimension, kSpacing);
};

TEST_P(Kernels, HaveAnIntegralOfOneAndSlopesOfTheirValue) {
  const int steps = 20000;
  const double dr = kernel_.support / steps, pi = std::numbers::pi;
  double integral = 0;
  for (int n = 0; n < steps; ++n) {
    const double r = (n + 0.5) * dr;
    integral += kernel_.value(r) * (kernel_.dimension == 2 ? 2 * pi * r : 4 * pi * r * r) * dr;
  }
  EXPECT_NEAR(integral, 1, 1e-6);
  for (const double share : {0.1, 0.3, 0.45, 0.6, 0.9}) {
    const double r = share * kernel_.support;
    const double slope = (kernel_.value(r + dr) - kernel_.value(r - dr)) / (2 * dr);
    EXPECT_NEAR(kernel_.slope_over_r(r) * r * kernel_.lattice / slope, 1, 1e-5) << share;
  }
}

// A field of slope 1 along x, and x^2, whose Laplacian is 2, seen from the particle in the middle of a lattice.
TEST_P(Kernels, GiveGradientAndLaplacianOnALattice) {
  const int n = 4, deep = kernel_.dimension == 3 ? n : 0;
  const double volume = std::pow(kSpacing, kernel_.dimension);
  double gradient = 0, laplacian = 0;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -deep; k <= deep; ++k) {
        const double x = i * kSpacing, r = kSpacing * std::sqrt(double(i * i + j * j + k * k));
        if (r == 0) continue;
        gradient += volume * x * -kernel_.slope_over_r(r) * x;
        laplacian += volume * 2 * x * x * -kernel_.slope_over_r(r);
      }
  EXPECT_NEAR(gradient, 1, 1e-12);
  EXPECT_NEAR(laplacian, 2, 1e-12);
  EXPECT_NEAR(kernel_.lattice, 1, 0.03);  // it mends the rounding by the sampling, no more
}

// The stiffest wave of displacements on a lattice under pressure, by every wave vector of a grid and every line of
// motion, with second derivatives from differences of W itself.
TEST_P(Kernels, SwingALatticeUnderPressureNoFasterThanTheySay) {
  const int n = 3, dim = kernel_.dimension, deep = dim == 3 ? n : 0, waves = 16;
  const double volume = std::pow(kSpacing, dim), dx = 1e-4 * kSpacing;
  const auto w = [&](const Eigen::Vector3d& at) { return kernel_.value(at.norm()) / kernel_.lattice; };
  std::vector<std::pair<Eigen::Vector3d, Eigen::Matrix3d>>
      pairs;  // place in spacings, 2 d^2 V times second derivatives
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j)
      for (int k = -deep; k <= deep; ++k) {
        const Eigen::Vector3d at(i, j, k);
        if (at.isZero() || at.norm() * kSpacing > kernel_.support) continue;
        Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
        for (int a = 0; a < dim; ++a)
          for (int b = 0; b < dim; ++b) {
            const Eigen::Vector3d ea = dx * Eigen::Vector3d::Unit(a), eb = dx * Eigen::Vector3d::Unit(b),
                                  x = kSpacing * at;
            second(a, b) = (w(x + ea + eb) - w(x + ea - eb) - w(x - ea + eb) + w(x - ea - eb)) / (4 * dx * dx);
          }
        pairs.emplace_back(at, 2 * kSpacing * kSpacing * volume * second);
      }
  double largest = 0;
  for (int i = 0; i <= waves; ++i)
    for (int j = 0; j <= i; ++j)
      for (int k = 0; k <= (dim == 3 ? j : 0); ++k) {
        const Eigen::Vector3d wave = std::numbers::pi / waves * Eigen::Vector3d(i, j, k);
        Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
        for (const auto& [at, second] : pairs) sum += (1 - std::cos(wave.dot(at))) * second;
        largest = std::max(largest, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvalues().maxCoeff());
      }
  EXPECT_NEAR(lattice_stiffness(kernel_, kSpacing) / largest, 1, 5e-3);
}

INSTANTIATE_TEST_SUITE_P(All, Kernels,
                         ::testing::Values(KernelCase{KernelKind::kCubic, 2}, KernelCase{KernelKind::kCubic, 3},
                                           KernelCase{KernelKind::kWendland, 2}, KernelCase{KernelKind::kWendland, 3}));

}  // namespace
}  // namespace ballast::fluid
