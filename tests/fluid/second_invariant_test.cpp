// Q, the second invariant of the velocity gradient, that apply_divergence finds beside the divergence.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "fluid_server/passes/passes.h"

namespace ballast::fluid {
namespace {

constexpr double kApart = 0.02;

/// Particles alone, in a box 0.4 m wide.
class Particles3 {
 public:
  Particles3(KernelKind kind, int dimension, const std::vector<Vec3>& places)
      : kernel_(Kernel::of(kind, dimension, kApart)), items_(coordinates_, kernel_.support, dimension, 2) {
    for (const Vec3& place : places) {
      const Fixed3 p = coordinates_.to_fixed(place);
      before_.record.push_back({p[0], p[1], p[2], 0, 0, 0, 0, static_cast<float>(std::pow(kApart, dimension))});
      before_.id.push_back(static_cast<std::uint32_t>(before_.id.size()));
    }
    items_.rebuild(before_, after_, {}, 0);
    constants_.kernel = kernel_, constants_.threads = 2;
    build_lists(items_, constants_);
  }
  /// Q of every particle, in the order of the places, where `velocity` gives theirs.
  template <class Velocity>
  std::vector<float> invariants(const Velocity& velocity) {
    std::vector<Flow> flow(items_.record.size());
    for (std::size_t f = 0; f < after_.size(); ++f) {
      const Vec3 v = velocity(after_.id[f]);
      flow[items_.fluid_item[f]] = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                                    after_.record[f].volume};
    }
    std::vector<float> divergence, sorted, out(after_.size());
    apply_divergence(items_, constants_, {}, flow, divergence, sorted);
    for (std::size_t f = 0; f < after_.size(); ++f) out[after_.id[f]] = sorted[f];
    return out;
  }
  const Kernel& kernel() const { return kernel_; }

 private:
  Coordinates coordinates_ = Coordinates::make({Vec3::Zero(), Vec3::Constant(0.4)}, {false, false, false});
  Kernel kernel_;
  Neighbourhood items_;
  Particles before_, after_;
  PassConstants constants_;
};

struct Case {
  KernelKind kind;
  int dimension;
};

class SecondInvariant : public ::testing::TestWithParam<Case> {};

TEST_P(SecondInvariant, MatchesItsDefinition) {
  const auto [kind, dimension] = GetParam();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(0.05, 0.35);
  std::vector<Vec3> places(dimension == 2 ? 400 : 3000), velocities(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    places[k] = Vec3(u(random), dimension == 2 ? 0.2 : u(random), u(random));
    velocities[k] = Vec3(u(random), dimension == 2 ? 0 : u(random), u(random));
  }
  Particles3 particles(kind, dimension, places);
  const std::vector<float> found = particles.invariants([&](std::uint32_t k) { return velocities[k]; });
  Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  if (dimension == 2) unit(1, 1) = 0;
  double worst = 0, largest = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Eigen::Matrix3d l = Eigen::Matrix3d::Zero();
    double fullness = 0;
    for (std::size_t j = 0; j < places.size(); ++j) {
      const Vec3 r = places[i] - places[j];
      if (i == j || r.norm() >= particles.kernel().support) continue;
      const double vg = std::pow(kApart, dimension) * particles.kernel().slope_over_r(r.norm());
      l += vg * (velocities[j] - velocities[i]) * r.transpose();
      fullness -= vg * r.squaredNorm() / dimension;
    }
    l /= std::max(fullness, 0.3);
    l -= l.trace() / dimension * unit;
    const double q = -0.5 * (l * l).trace();
    worst = std::max(worst, std::abs(q - found[i])), largest = std::max(largest, std::abs(q));
  }
  EXPECT_GT(largest, 0);
  EXPECT_LT(worst, 1e-5 * largest);
}

/// Straight moves by a linear flow without divergence change the volume by det(1 + t L) = 1 + t^2 Q + t^3 det L.
TEST_P(SecondInvariant, IsTheVolumeThatStraightMovesOfALinearFlowGain) {
  const auto [kind, dimension] = GetParam();
  constexpr double kTime = 1e-3;
  std::vector<Vec3> places;
  for (int i = 0; i < 13 * 13 * (dimension == 2 ? 1 : 13); ++i)
    places.push_back(kApart * Vec3(4 + i % 13, dimension == 2 ? 10 : 4 + i / 169, 4 + i / 13 % 13));
  const std::size_t middle = places.size() / 2;
  Particles3 particles(kind, dimension, places);
  std::vector<Eigen::Matrix3d> gradients(3, Eigen::Matrix3d::Zero());
  gradients[0].diagonal() << 4, 0, -4;              // strain
  gradients[1](0, 2) = 5, gradients[1](2, 0) = -5;  // rotation
  gradients[2] << 1, 2, -3, 0.5, -2, 1, 4, -1, 1;   // both
  if (dimension == 2) gradients[2] << 1, 0, -3, 0, 0, 0, 4, 0, -1;
  for (const Eigen::Matrix3d& l : gradients) {
    const std::vector<float> found = particles.invariants([&](std::uint32_t k) -> Vec3 { return l * places[k]; });
    const double gained = (Eigen::Matrix3d::Identity() + kTime * l).determinant() - 1;
    EXPECT_NEAR(found[middle], gained / (kTime * kTime) - kTime * l.determinant(), 1e-3 * l.squaredNorm());
  }
}

INSTANTIATE_TEST_SUITE_P(All, SecondInvariant,
                         ::testing::Values(Case{KernelKind::kCubic, 3}, Case{KernelKind::kWendland, 3},
                                           Case{KernelKind::kCubic, 2}, Case{KernelKind::kWendland, 2}));

}  // namespace
}  // namespace ballast::fluid
