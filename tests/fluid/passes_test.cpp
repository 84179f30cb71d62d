// The vector passes against brute force in double over all pairs, with the kernels of kernel.h.
#include "fluid_server/passes/passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace ballast::fluid {
namespace {

struct PassCase {
  int dimension;
  KernelKind kind;
  bool periodic;
  int threads;
};

class Passes : public ::testing::TestWithParam<PassCase> {
 protected:
  static constexpr double kSpacing = 0.02;

  Passes()
      : kernel_{Kernel::of(GetParam().kind, GetParam().dimension, kSpacing)},
        coordinates_(Coordinates::make(domain(), {GetParam().periodic, false, GetParam().periodic})),
        items_(coordinates_, kernel_.support, GetParam().dimension, GetParam().threads) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> u(0.0, 1.0);
    const Box3 box = domain();
    const int count = GetParam().dimension == 2 ? 900 : 4000;
    for (int k = 0; k < count; ++k) {
      Vec3 p = box.min + Vec3(u(random), u(random), u(random)).cwiseProduct(box.max - box.min);
      if (GetParam().dimension == 2) p[1] = 0;
      const Fixed3 f = coordinates_.to_fixed(p);
      Record r{f[0],
               f[1],
               f[2],
               float(1000 * u(random) - 100),
               float(u(random) - 0.5),
               float(u(random) - 0.5),
               float(u(random) - 0.5),
               float(8e-6 * (0.5 + u(random)))};
      if (GetParam().dimension == 2) r.vy = 0;
      if (k % 5 == 0) {
        r.volume = -r.volume;
        (k % 2 ? fixed_ : moving_).push_back(r);
      } else {
        before_.record.push_back(r);
        before_.id.push_back(static_cast<std::uint32_t>(before_.id.size()));
      }
    }
    extras_.density.assign(1, 1000.f);
    constants_.kernel = kernel_;
    constants_.sound_speed = 2;
    constants_.diffusion = 0.1f;
    constants_.artificial_viscosity = 0.02f;
    constants_.gravity[2] = -9.81f;
    constants_.dt = 1e-4f;
    constants_.threads = GetParam().threads;
    items_.set_static_samples(fixed_);
    items_.rebuild(before_, after_, moving_, static_cast<std::uint32_t>(fixed_.size()));
    constants_.ram_on_samples = true;
    for (std::uint32_t item = 0; item < items_.size(); ++item) {
      Eigen::Vector3f n(float(u(random) - 0.5), GetParam().dimension == 2 ? 0.f : float(u(random) - 0.5),
                        float(u(random) - 0.5));
      n.normalize();
      extras_.normal.push_back({n[0], n[1], n[2], 0.f});
    }
  }

  /// rho (alpha c u + u^2) between particles; with a sample rho u^2, u at most the speed against its surface.
  double dissipation(std::uint32_t particle, std::uint32_t other) const {
    const Record &a = items_.record[particle], &b = items_.record[other];
    const Vec3 r = difference(a, b), relative = velocity(a) - velocity(b);
    const double u = std::max(0.0, -relative.dot(r) / r.norm());
    if (b.volume > 0) return 1000 * u * (u + 0.02 * 2);
    const NormalRecord& n = extras_.normal[other];
    return 1000 * std::pow(std::clamp(-relative.dot(Vec3(n.x, n.y, n.z)), 0.0, u), 2);
  }

  static Box3 domain() {
    return GetParam().dimension == 2 ? Box3{{-0.3, -0.5, 0.1}, {0.31, 0.5, 0.7}}
                                     : Box3{{-0.15, 0.02, 0.1}, {0.2, 0.3, 0.4}};
  }
  Vec3 difference(const Record& a, const Record& b) const {
    Vec3 r = coordinates_.difference({a.x, a.y, a.z}, {b.x, b.y, b.z});
    if (GetParam().dimension == 2) r[1] = 0;
    return r;
  }
  static Vec3 velocity(const Record& r) { return {r.vx, r.vy, r.vz}; }
  /// Builds the lists; 1 / sum V W of each sample, 0 where dry.
  std::vector<float> build_and_weigh() {
    build_lists(items_, constants_);
    std::vector<SampleSums> sums;
    gather_samples(items_, extras_, constants_, sums);
    std::vector<float> inverse_w;
    for (const SampleSums& s : sums) inverse_w.push_back(s.w > 0 ? 1 / s.w : 0.f);
    std::vector<RowSums> rows;
    sum_rows(items_, extras_, constants_, rows, pairs_);
    return inverse_w;
  }
  double slope(double r) const { return kernel_.slope_over_r(r); }

  Kernel kernel_;
  Coordinates coordinates_;
  Neighbourhood items_;
  Particles before_, after_;
  std::vector<Record> fixed_, moving_;
  PassConstants constants_;
  ItemExtras extras_;
  KeptPairs pairs_;
};

TEST_P(Passes, SortingKeepsEveryParticleAndCellOrder) {
  std::set<std::uint32_t> ids(after_.id.begin(), after_.id.end());
  EXPECT_EQ(ids.size(), before_.size());
  for (std::size_t f = 0; f < after_.size(); ++f) {
    EXPECT_EQ(0, std::memcmp(&after_.record[f], &before_.record[after_.id[f]], sizeof(Record)));
    EXPECT_EQ(items_.source[items_.fluid_item[f]], f);
  }
  std::uint32_t last = 0;
  for (std::uint32_t i = 0; i < items_.size(); ++i) {
    const std::uint32_t cell = items_.cells().cell(items_.x[i], items_.y[i], items_.z[i]);
    EXPECT_GE(cell, last);
    last = cell;
  }
}

TEST_P(Passes, SortingAgainAfterEverythingMovedKeepsEveryParticle) {
  for (int round = 0; round < 5; ++round) {
    for (std::size_t f = 0; f < after_.size(); ++f)
      after_.record[f].z = after_.record[f].z / 2 + 0x20000000u * (round % 3);
    std::swap(before_, after_);
    items_.rebuild(before_, after_, moving_, static_cast<std::uint32_t>(fixed_.size()));
    std::set<std::uint32_t> ids(after_.id.begin(), after_.id.end());
    ASSERT_EQ(ids.size(), before_.size());
    ASSERT_EQ(items_.size(), items_.fluid_item.size() + items_.sample_item.size());
    for (std::size_t f = 0; f < after_.size(); ++f) ASSERT_EQ(items_.source[items_.fluid_item[f]], f);
    for (std::uint32_t item : items_.sample_item) ASSERT_TRUE(items_.source[item] & Neighbourhood::kSample);
  }
}

TEST_P(Passes, ListsHoldExactlyTheNeighboursWithinTheSupport) {
  build_lists(items_, constants_);
  std::size_t pairs = 0;
  for (std::uint32_t i = 0; i < items_.size(); ++i) {
    std::set<std::uint32_t> listed(items_.lists.of(i), items_.lists.of(i) + items_.lists.count[i]);
    EXPECT_EQ(listed.size(), items_.lists.count[i]) << "an item is listed twice for " << i;
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      const double r = difference(items_.record[i], items_.record[j]).norm();
      if (std::abs(r - kernel_.support) < 1e-6 * kernel_.support) continue;  // either way at the rim
      const bool sample_pair = items_.record[i].volume < 0 && items_.record[j].volume < 0;
      const bool wanted = i != j && !sample_pair && r < kernel_.support;
      ASSERT_EQ(listed.count(j), wanted ? 1u : 0u)
          << "pair " << i << " " << j << " at " << r / kernel_.support << " supports";
      pairs += wanted;
    }
  }
  EXPECT_GT(pairs, 5000u);
}

TEST_P(Passes, PressureAdvancesByContinuityAndDiffusion) {
  std::vector<float> advanced;
  build_lists_and_advance_pressure(items_, extras_, constants_, advanced);
  const double rho = 1000, c = 2;
  double worst = 0, largest = 0;
  int surface = 0, kept = 0;
  for (std::size_t f = 0; f < after_.size(); ++f) {
    const Record& own = after_.record[f];
    double divergence = 0, of_fluid = 0, diffusion = 0, fluid = 0, solid = 0;
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      const Record& other = items_.record[j];
      const Vec3 r = difference(own, other);
      if (j == items_.fluid_item[f] || r.norm() >= kernel_.support) continue;
      const double g = slope(r.norm());
      (other.volume > 0 ? fluid : solid) -= std::abs(other.volume) * g * r.squaredNorm();
      const double closing = std::abs(other.volume) * g * (velocity(own) - velocity(other)).dot(r);
      divergence += closing;
      if (other.volume > 0) of_fluid += closing;
      if (other.volume > 0) diffusion += other.volume * g * (other.p - own.p + rho * -9.81 * r[2]);
    }
    const double change = 1e-4 * (rho * c * c * divergence - 2 * 0.1 * kernel_.h() * c * diffusion);
    const double room = std::max(GetParam().dimension - solid, 0.15 * GetParam().dimension);
    double expected = own.p + change;
    const double left = 1e-4 * rho * c * c * (of_fluid - divergence);  // the part of solids that move away
    if (left > 0 && fluid + solid < 0.9 * GetParam().dimension) {
      const double least = fluid > 0.6 * GetParam().dimension ? std::max(double(own.p), 0.0) : 0.0;
      kept += least > expected;
      expected = std::clamp(least, expected, expected + left);
    }
    const bool spray = fluid + solid < 0.5 * GetParam().dimension || fluid < 0.2 * room;
    if (spray && expected < 0) {
      EXPECT_EQ(advanced[f], 0.f) << "tension in spray";
      ++surface;
      continue;
    }
    worst = std::max(worst, std::abs(advanced[f] - expected));
    largest = std::max(largest, std::abs(change));
  }
  EXPECT_GT(surface, 0);
  EXPECT_GT(kept, 0) << "beside air a solid that moves away does not lower the pressure";
  EXPECT_LT(worst, 2e-5 * (largest + 1000)) << "single precision of the pressure itself is 6e-8 of 1000 Pa";
}

TEST_P(Passes, AccelerationEqualsTheSumOverPairs) {
  build_lists(items_, constants_);
  std::vector<float> a;
  accelerate(items_, extras_, constants_, a);
  const double rho = 1000;
  double worst = 0, largest = 0;
  for (std::size_t f = 0; f < after_.size(); ++f) {
    const Record& own = after_.record[f];
    Vec3 sum(0, 0, -9.81);
    double scale = 0;
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      const Record& other = items_.record[j];
      const Vec3 r = difference(own, other);
      if (j == items_.fluid_item[f] || r.norm() >= kernel_.support) continue;
      const double q = dissipation(items_.fluid_item[f], j);
      const Vec3 one = -std::abs(other.volume) * (own.p + other.p + q) * slope(r.norm()) * r / rho;
      sum += one;
      scale += one.norm();
    }
    worst = std::max(worst, (sum - Vec3(a[3 * f], a[3 * f + 1], a[3 * f + 2])).norm());
    largest = std::max(largest, scale);
  }
  EXPECT_LT(worst, 1e-5 * largest);
}

TEST_P(Passes, SummedDensityCountsTheParticleItselfOnce) {
  build_lists(items_, constants_);
  std::vector<float> delta, gradient;
  sum_density(items_, constants_, delta, gradient);
  for (std::size_t f = 0; f < after_.size(); ++f) {
    double sum = 0;
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      const double r = difference(after_.record[f], items_.record[j]).norm();
      if (r < kernel_.support) sum += std::abs(items_.record[j].volume) * kernel_.value(r);
    }
    ASSERT_NEAR(delta[f], sum, 1e-5 * sum);
  }
}

TEST_P(Passes, UnevennessEqualsTheSumsOverPairs) {
  build_lists(items_, constants_);
  std::vector<Unevenness> uneven;
  find_unevenness(items_, constants_, kSpacing, uneven);
  ASSERT_EQ(uneven.size(), after_.size());
  double worst_push = 0, worst_dense = 0, largest = 0;
  for (std::size_t f = 0; f < after_.size(); ++f) {
    const Record& own = after_.record[f];
    Vec3 push = Vec3::Zero(), dense = Vec3::Zero();
    double speed = 0, full = 0, solid = 0, scale = 0;
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      const Record& other = items_.record[j];
      const Vec3 r = difference(own, other);
      if (j == items_.fluid_item[f] || r.norm() >= kernel_.support) continue;
      const Vec3 gradient = std::abs(other.volume) * slope(r.norm()) * r;
      const double near = kernel_.value(r.norm()) / kernel_.value(kSpacing);
      push -= (1 + 0.2 * std::pow(near, 4)) * gradient;
      dense += (other.volume > 0 ? 2 : 1) * gradient;
      full -= std::abs(other.volume) * slope(r.norm()) * r.squaredNorm() / GetParam().dimension;
      if (other.volume < 0) solid -= std::abs(other.volume) * slope(r.norm()) * r.squaredNorm() / GetParam().dimension;
      if (other.volume > 0 && r.norm() < 0.999 * kernel_.support)
        speed = std::max(speed, (velocity(own) - velocity(other)).norm());
      scale += (1 + 0.2 * std::pow(near, 4)) * gradient.norm();
    }
    worst_push = std::max(worst_push, (push - Eigen::Vector3f::Map(uneven[f].push).cast<double>()).norm());
    worst_dense = std::max(worst_dense, (dense - Eigen::Vector3f::Map(uneven[f].dense).cast<double>()).norm());
    largest = std::max(largest, scale);
    ASSERT_NEAR(uneven[f].fullness, full, 1e-5 * (1 + full));
    ASSERT_NEAR(uneven[f].solid, solid, 1e-5 * (1 + full));
    ASSERT_GE(uneven[f].speed, (1 - 1e-6) * speed);
    ASSERT_LE(uneven[f].speed, 1.8);
  }
  EXPECT_LT(worst_push, 1e-5 * largest);
  EXPECT_LT(worst_dense, 1e-5 * largest);
}

TEST_P(Passes, SampleSumsSeeOnlyFluid) {
  build_lists(items_, constants_);
  std::vector<SampleSums> sums;
  gather_samples(items_, extras_, constants_, sums);
  ASSERT_EQ(sums.size(), items_.sample_item.size());
  double worst = 0, largest = 0, worst_pg = 0, largest_pg = 0;
  std::size_t wet = 0;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    const Record& own = items_.record[items_.sample_item[s]];
    double w = 0, wp = 0, nearest = kernel_.support;
    Vec3 g = Vec3::Zero(), pg = Vec3::Zero();
    for (std::size_t f = 0; f < after_.size(); ++f) {
      const Record& other = after_.record[f];
      const Vec3 r = difference(own, other);
      if (r.norm() >= kernel_.support) continue;
      const double q = dissipation(items_.fluid_item[f], items_.sample_item[s]);
      pg += (other.p + q) * other.volume * slope(r.norm()) * r;
      w += other.volume * kernel_.value(r.norm());
      wp += other.volume * kernel_.value(r.norm()) * other.p;
      g += other.volume * slope(r.norm()) * r;
      nearest = std::min(nearest, r.norm());
    }
    if (w == 0) continue;
    ++wet;
    EXPECT_NEAR(sums[s].w, w, 1e-5 * w);
    EXPECT_NEAR(sums[s].wp, wp, 1e-5 * wp);
    EXPECT_NEAR(sums[s].nearest, nearest, 1e-5 * kernel_.support);
    worst = std::max(worst, (g - Eigen::Vector3f::Map(sums[s].g).cast<double>()).norm());
    largest = std::max(largest, g.norm());
    worst_pg = std::max(worst_pg, (pg - Eigen::Vector3f::Map(sums[s].pg).cast<double>()).norm());
    largest_pg = std::max(largest_pg, pg.norm());
  }
  EXPECT_LT(worst, 1e-5 * largest);
  EXPECT_LT(worst_pg, 1e-5 * largest_pg);
  EXPECT_GT(wet, 50u);
}

/// The power of the pressures' forces, on particles and on samples (those by brute force), is pressure times
/// divergence.
TEST_P(Passes, DivergenceIsTheTransposeOfTheForce) {
  const std::vector<float> inverse_w = build_and_weigh();
  std::vector<float> pressure, out, divergence, invariant;
  for (const std::uint32_t item : items_.fluid_item) pressure.push_back(items_.record[item].p);
  std::vector<Flow> flow, velocities(items_.record.size());
  weigh_samples(items_, inverse_w, constants_.threads, pairs_, flow);
  apply_pressure(items_, extras_, constants_, pairs_, pressure, flow, out);
  double power = 0, scale = 0;
  for (std::uint32_t item = 0; item < items_.size(); ++item) {
    const Record& r = items_.record[item];
    velocities[item] = {r.vx, r.vy, r.vz, r.volume};
    if (r.volume > 0) {
      const Vec3 force = 1000.0 * r.volume * Vec3(flow[item].x, flow[item].y, flow[item].z);
      power += force.dot(velocity(r)), scale += std::abs(force.dot(velocity(r)));
    }
  }
  for (std::size_t s = 0; s < inverse_w.size(); ++s) {
    const Record& b = items_.record[items_.sample_item[s]];
    double w = 0, wp = 0;
    for (std::size_t f = 0; f < pressure.size(); ++f) {
      const Record& k = items_.record[items_.fluid_item[f]];
      const double weight = k.volume * kernel_.value(difference(b, k).norm());
      w += weight, wp += weight * pressure[f];
    }
    if (!(w > 0)) continue;
    Vec3 force = Vec3::Zero();
    for (std::size_t f = 0; f < pressure.size(); ++f) {
      const Record& k = items_.record[items_.fluid_item[f]];
      const Vec3 r = difference(b, k);
      if (r.norm() < kernel_.support) force += b.volume * k.volume * (pressure[f] + wp / w) * slope(r.norm()) * r;
    }
    power += force.dot(velocity(b)), scale += std::abs(force.dot(velocity(b)));
  }
  apply_divergence(items_, constants_, inverse_w, velocities, divergence, invariant);
  double other = 0;
  for (std::size_t f = 0; f < pressure.size(); ++f) other += static_cast<double>(pressure[f]) * divergence[f];
  EXPECT_NEAR(power, other, 1e-5 * scale);
}

TEST_P(Passes, PressureOperatorIsSymmetricAndPositive) {
  const std::vector<float> inverse_w = build_and_weigh();
  std::mt19937 random(11);
  std::normal_distribution<float> normal;
  std::vector<float> x[2], ax[2];
  std::vector<Flow> flow;
  weigh_samples(items_, inverse_w, constants_.threads, pairs_, flow);
  for (int k = 0; k < 2; ++k) {
    for (std::size_t f = 0; f < items_.fluid_item.size(); ++f) x[k].push_back(normal(random));
    apply_pressure(items_, extras_, constants_, pairs_, x[k], flow, ax[k]);
  }
  const auto dot = [](const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += static_cast<double>(a[i]) * b[i];
    return sum;
  };
  EXPECT_GT(dot(x[0], ax[0]), 0);
  EXPECT_NEAR(dot(x[0], ax[1]), dot(x[1], ax[0]), 1e-5 * dot(x[0], ax[0]));
}

INSTANTIATE_TEST_SUITE_P(All, Passes,
                         ::testing::Values(PassCase{3, KernelKind::kCubic, false, 1},
                                           PassCase{3, KernelKind::kWendland, false, 2},
                                           PassCase{3, KernelKind::kCubic, true, 3},
                                           PassCase{2, KernelKind::kCubic, false, 2},
                                           PassCase{2, KernelKind::kWendland, true, 2}));

}  // namespace
}  // namespace ballast::fluid
