// The viscous sum: second derivatives on lattices that the flow has sheared, against their exact values; the sums over
// pairs against brute force in double; what particles and samples do to each other.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fluid_server/passes/passes.h"

namespace ballast::fluid {
namespace {

struct ViscousCase {
  int dimension;
  KernelKind kind;
};

class Viscous : public ::testing::TestWithParam<ViscousCase> {
 protected:
  static constexpr double kSpacing = 0.05, kDensity = 1000, kViscosity = 1000;  // m, kg/m^3, Pa s

  bool deep() const { return GetParam().dimension == 3; }

  /// A cube of 1 m (0.8 m deep in 3-D) on a lattice sheared along x by `shear` per height, with places off by `jitter`
  /// spacings; below `bottom` (m) there are samples.
  void place(double shear, double jitter = 0, double bottom = 0) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, jitter * kSpacing);
    samples_.clear();
    const int layers = deep() ? 16 : 1;
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < layers; ++j)
        for (int k = 0; k < 20; ++k) {
          Vec3 p((i + 0.5) * kSpacing, deep() ? (j + 0.5) * kSpacing : 0, (k + 0.5) * kSpacing);
          p[0] = std::fmod(p[0] + shear * p[2], 1.0);
          if (jitter > 0) p += Vec3(noise(random), deep() ? noise(random) : 0, noise(random));
          const Fixed3 f = coordinates_.to_fixed(p);
          const float volume = static_cast<float>(std::pow(kSpacing, GetParam().dimension));
          const bool sample = p[2] < bottom;
          Record r{f[0], f[1], f[2], 0, 0, 0, 0, sample ? -volume : volume};
          if (sample) {
            samples_.push_back(r);
          } else {
            before_.record.push_back(r);
            before_.id.push_back(static_cast<std::uint32_t>(before_.id.size()));
          }
        }
    items_.set_static_samples(samples_);
    items_.rebuild(before_, after_, {}, static_cast<std::uint32_t>(samples_.size()));
    constants_.kernel = kernel_;
    constants_.sound_speed = 1;
    constants_.viscous = true;
    constants_.threads = 2;
    extras_.density.assign(1, static_cast<float>(kDensity));
    build_lists(items_, constants_);
    find_evening(items_, constants_, extras_.evening);
    extras_.viscous.resize(items_.size());
  }

  /// Velocities so small that nothing but viscosity matters.
  template <class Field>
  void set_velocity(Field&& v) {
    for (std::uint32_t item = 0; item < items_.size(); ++item) {
      Record& r = items_.record[item];
      const Eigen::Vector3f u = (1e-4 * v(position(r))).template cast<float>();
      r.vx = u[0], r.vy = u[1], r.vz = u[2];
      extras_.viscous[item] = {u[0], u[1], u[2], r.volume < 0 ? -1.f : static_cast<float>(kViscosity)};
    }
  }

  Vec3 position(const Record& r) const {
    Vec3 x = coordinates_.to_metres(r.x, r.y, r.z);
    if (!deep()) x[1] = 0;
    return x;
  }
  bool inside(const Vec3& x) const {
    const double margin = kernel_.support + kSpacing;
    return x[0] > margin && x[0] < 1 - margin && x[2] > margin && x[2] < 1 - margin &&
           (!deep() || (x[1] > margin && x[1] < 0.8 - margin));
  }

  /// sum V_j g weight(item, j, e) r r over all items.
  template <class Weight>
  Eigen::Matrix3d moments(std::uint32_t item, Weight&& weight) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      Vec3 r = difference(item, j);
      if (j == item || r.norm() >= kernel_.support) continue;
      sum += std::abs(items_.record[j].volume) * kernel_.slope_over_r(r.norm()) * weight(r.normalized()) * r *
             r.transpose();
    }
    return sum;
  }
  Vec3 difference(std::uint32_t a, std::uint32_t b) const {
    const Record &i = items_.record[a], &j = items_.record[b];
    Vec3 r = coordinates_.difference({i.x, i.y, i.z}, {j.x, j.y, j.z});
    if (!deep()) r[1] = 0;
    return r;
  }
  static double along(const Evening& c, const Vec3& e) {
    return c.xx * e[0] * e[0] + c.yy * e[1] * e[1] + c.zz * e[2] * e[2] + c.xy * e[0] * e[1] + c.yz * e[1] * e[2] +
           c.zx * e[2] * e[0];
  }

  Kernel kernel_{Kernel::of(GetParam().kind, GetParam().dimension, kSpacing)};
  Coordinates coordinates_{Coordinates::make({{0, 0, 0}, {1, 0.8, 1}}, {true, false, false})};
  Neighbourhood items_{coordinates_, kernel_.support, GetParam().dimension, 2};
  std::vector<Record> samples_;
  Particles before_, after_;
  PassConstants constants_;
  ItemExtras extras_;
};

TEST_P(Viscous, SecondDerivativesAreRightOnShearedLattices) {
  for (const double shear : {0.0, 0.2, 0.35, 0.5}) {
    before_ = {};
    place(shear);
    set_velocity([this](const Vec3& x) {
      const double y = deep() ? x[1] : 0;
      return Vec3(x[2] * x[2] + 0.5 * y * y, 0, x[0] * x[2] + x[0] * y);
    });
    const Vec3 exact = 1e-4 * kViscosity / kDensity * Vec3(deep() ? 3 : 2, 0, 0);
    const auto largest_error = [&] {
      std::vector<float> a;
      accelerate(items_, extras_, constants_, a);
      double error = 0;
      for (std::size_t f = 0; f < after_.size(); ++f)
        if (inside(position(after_.record[f])))
          error = std::max(error, (Vec3(a[3 * f], a[3 * f + 1], a[3 * f + 2]) - exact).norm() / exact.norm());
      EXPECT_GT(error, 0) << "rounding at least";
      return error;
    };
    const double weighted = largest_error();
    EXPECT_LT(weighted, 8e-4) << shear;
    extras_.evening.assign(extras_.evening.size(), {});
    if (shear == 0) continue;
    EXPECT_LT(weighted, 0.4 * largest_error()) << shear;  // of all pairs weighted alike
  }
}

TEST_P(Viscous, WeightsMakeUpForMostOfWhatDisorderTakes) {
  place(0, 0.04);
  double before = 0, after = 0;
  int inner = 0;
  for (std::size_t f = 0; f < after_.size(); ++f) {
    const std::uint32_t item = items_.fluid_item[f];
    if (!inside(position(after_.record[f]))) continue;
    Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    if (!deep()) one(1, 1) = 0;
    before += (one + moments(item, [](const Vec3&) { return 1.0; })).norm();
    after += (one + moments(item, [&](const Vec3& e) { return 1 + along(extras_.evening[item], e); })).norm();
    ++inner;
  }
  EXPECT_GT(before, 0.01 * inner);
  EXPECT_LT(after, (GetParam().kind == KernelKind::kCubic ? 0.35 : 0.25) * before);
}

TEST_P(Viscous, WeightsFadeAtASurface) {
  place(0);
  int top = 0;
  for (std::size_t f = 0; f < after_.size(); ++f) {
    if (position(after_.record[f])[2] < 1 - kSpacing) continue;
    const Evening& c = extras_.evening[items_.fluid_item[f]];
    for (const float x : {c.xx, c.yy, c.zz, c.xy, c.yz, c.zx}) EXPECT_EQ(x, 0);
    ++top;
  }
  EXPECT_EQ(top, deep() ? 320 : 20);
}

TEST_P(Viscous, SumsEqualThoseOverAllPairsAndActionEqualsReaction) {
  place(0.3, 0.03, 0.2);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  set_velocity([&](const Vec3&) { return Vec3(u(random), deep() ? u(random) : 0, u(random)); });
  for (std::uint32_t item : items_.sample_item)  // counts for nothing
    extras_.evening[item] = {1e6f, 1e6f, 1e6f, 1e6f, 1e6f, 1e6f, {}};
  std::vector<float> a;
  accelerate(items_, extras_, constants_, a);
  Vec3 force = Vec3::Zero();
  double worst = 0, largest = 0, scale = 0;
  for (std::size_t f = 0; f < after_.size(); ++f) {
    const std::uint32_t item = items_.fluid_item[f];
    const ViscousRecord& own = extras_.viscous[item];
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t j = 0; j < items_.size(); ++j) {
      const Vec3 r = difference(item, j);
      if (j == item || r.norm() >= kernel_.support) continue;
      const ViscousRecord& other = extras_.viscous[j];
      const double mine = along(extras_.evening[item], r.normalized());
      const double theirs = other.mu < 0 ? mine : along(extras_.evening[j], r.normalized());
      sum += std::abs(items_.record[j].volume) * 2 * kViscosity * (1 + (mine + theirs) / 2) *
             kernel_.slope_over_r(r.norm()) * Vec3(own.wx - other.wx, own.wy - other.wy, own.wz - other.wz) / kDensity;
    }
    const Vec3 found(a[3 * f], a[3 * f + 1], a[3 * f + 2]);
    worst = std::max(worst, (found - sum).norm());
    largest = std::max(largest, sum.norm());
    force += kDensity * after_.record[f].volume * found;
    scale += kDensity * after_.record[f].volume * found.norm();
  }
  EXPECT_LT(worst, 1e-5 * largest);
  std::vector<ViscousSums> sums;
  gather_viscous(items_, extras_, constants_, sums);
  Vec3 on_samples = Vec3::Zero();
  for (std::size_t s = 0; s < sums.size(); ++s) {
    const ViscousRecord& w = extras_.viscous[items_.sample_item[s]];
    const double volume = -items_.record[items_.sample_item[s]].volume;
    on_samples += volume * (sums[s].a * Vec3(w.wx, w.wy, w.wz) - Vec3(sums[s].av[0], sums[s].av[1], sums[s].av[2]));
  }
  EXPECT_GT(on_samples.norm(), 1e-4 * scale);
  EXPECT_LT((force + on_samples).norm(), 1e-6 * scale);
}

INSTANTIATE_TEST_SUITE_P(Kernels, Viscous,
                         ::testing::Values(ViscousCase{2, KernelKind::kWendland}, ViscousCase{3, KernelKind::kWendland},
                                           ViscousCase{3, KernelKind::kCubic}));

}  // namespace
}  // namespace ballast::fluid
