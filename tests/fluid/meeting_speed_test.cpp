// The speed at which particles meet what is around them, on hand-made neighbours and against brute force.
#include "fluid_server/step/meeting_speed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fluid_server/passes/passes.h"

namespace ballast::fluid {
namespace {

/// Particles and fixed samples, sorted and listed; kernel support 0.1 m.
class MeetingSpeed : public ::testing::Test {
 protected:
  void particle(const Vec3& at, const Vec3& velocity) { before_.record.push_back(record(at, velocity, 1e-6f)); }
  void wall(const Vec3& at) { fixed_.push_back(record(at, Vec3::Zero(), -1e-6f)); }
  double find(double alone) {
    for (std::uint32_t k = 0; k < before_.size(); ++k) before_.id.push_back(k);
    PassConstants constants;
    constants.kernel = {KernelKind::kCubic, 3, 0.1};
    items_.set_static_samples(fixed_);
    items_.rebuild(before_, after_, {}, static_cast<std::uint32_t>(fixed_.size()));
    build_lists(items_, constants);
    return meeting_speed(after_, items_, alone, 1);
  }
  Record record(const Vec3& at, const Vec3& v, float volume) const {
    const Fixed3 f = coordinates_.to_fixed(at);
    return {f[0], f[1], f[2], 0, float(v[0]), float(v[1]), float(v[2]), volume};
  }
  Coordinates coordinates_ = Coordinates::make({{0, 0, 0}, {2, 2, 2}}, {});
  Neighbourhood items_{coordinates_, 0.1, 3, 1};
  Particles before_, after_;
  std::vector<Record> fixed_;
};

TEST_F(MeetingSpeed, ADropInFreeFlightCountsForAShare) {
  particle({1, 1, 1}, {3, 0, -4});
  EXPECT_NEAR(find(0.4), 2, 1e-6);
}

TEST_F(MeetingSpeed, DropsThatFlyTogetherDoNotMeet) {
  particle({1, 1, 1}, {3, 0, -4});
  particle({1.05, 1, 1}, {3, 0, -3.9});
  EXPECT_NEAR(find(0.01), 0.1, 1e-6);
}

TEST_F(MeetingSpeed, OppositeParticlesMeetWithTheSumOfTheirSpeeds) {
  particle({1, 1, 1}, {3, 0, 0});
  particle({1.05, 1, 1}, {-2, 0, 0});
  EXPECT_NEAR(find(0.4), 5, 1e-6);
}

TEST_F(MeetingSpeed, ADropMeetsAWallInSight) {
  particle({1, 1, 1}, {3, 0, -4});
  wall({1, 1, 0.91});
  EXPECT_NEAR(find(0.4), 5, 1e-6);
}

TEST_F(MeetingSpeed, IsThatOfTheWorstPairOfAFew) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(0, 0.4), v(-1, 1);
  for (int k = 0; k < 60; ++k)
    particle(Vec3(1, 1, 1) + Vec3(u(random), u(random), u(random)), Vec3(v(random), v(random), v(random)));
  const double found = find(0);
  double against = 0;
  for (const Record& a : after_.record)
    for (const Record& b : after_.record)
      if (coordinates_.difference({a.x, a.y, a.z}, {b.x, b.y, b.z}).norm() < 0.1)
        against = std::max(against, (Vec3(a.vx, a.vy, a.vz) - Vec3(b.vx, b.vy, b.vz)).norm());
  EXPECT_GT(against, 1);
  EXPECT_NEAR(found, against, 1e-5);
}

/// Only the fastest are looked at, a stream of others is taken to flow past something at rest.
TEST_F(MeetingSpeed, ManyCountWithTheirOwnSpeed) {
  for (int k = 0; k < 1000; ++k) particle({0.1 + 0.0015 * k, 1, 1}, {1, 0, 0});
  EXPECT_NEAR(find(0.4), 1, 1e-6);
}

}  // namespace
}  // namespace ballast::fluid
