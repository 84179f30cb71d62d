// Probes of a field that is known: water that turns as a rigid body.
#include "fluid_server/probes/probes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/geometry/bodies.h"

namespace ballast::fluid {
namespace {

/// A lattice of water of 1 m, without anything else.
Scene water_of_a_metre(int dimension) {
  Scene scene;
  scene.world.spacing = 0.05;
  scene.world.dimension = dimension;
  scene.numerics.sound_speed = 20;
  scene.numerics.relax = false;
  Fluid water;
  water.fill.box = {{0, -0.5, 0}, {1, 0.5, 1}};
  scene.fluids = {water};
  return scene;
}

class Turning : public ::testing::TestWithParam<int> {
 protected:
  Turning() {
    Scene scene;
    scene.world.spacing = 0.05;
    scene.world.dimension = GetParam();
    scene.numerics.sound_speed = 20;
    Fluid water;
    water.fill.box = {{0, -0.5, 0}, {1, 0.5, 1}};
    water.velocity = {0.3, 0, -0.1};
    water.angular_velocity = {0, 2, 0};
    scene.fluids = {water};
    bodies_ = *make_bodies(scene);
    fluid_ = *WcsphFluid::make(scene, bodies_, 1);
  }
  std::vector<Body> bodies_;
  std::unique_ptr<WcsphFluid> fluid_;
};

TEST_P(Turning, VelocityIsExactInsideAndAtAnEdge) {
  // v + w x (p - centre): a mean over the kernel would be wrong by w times a tenth of a metre at the edge.
  for (const Vec3& p : {Vec3(0.5, 0, 0.5), Vec3(0.313, 0.012, 0.77), Vec3(0.01, 0, 0.01), Vec3(0.99, 0, 0.4)}) {
    const Vec3 exact = Vec3(0.3, 0, -0.1) + Vec3(0, 2, 0).cross(p - Vec3(0.5, 0, 0.5));
    EXPECT_LT((velocity_at(*fluid_, p) - exact).norm(), 1e-5) << p.transpose();
  }
}

TEST_P(Turning, VelocityOfAParabolaIsExactInsideAndNearAtAWall) {
  // A linear fit takes the top off, by half of the curvature (2) times 0.6 spacings squared; at the wall it is one.
  const Scene scene = water_of_a_metre(GetParam());
  const auto fluid = *WcsphFluid::make(scene, *make_bodies(scene), 1);
  for (Record& r : const_cast<Particles&>(fluid->particles()).record) {
    const double z = fluid->coordinates().to_metres(r.x, r.y, r.z)[2];
    r.vx = static_cast<float>(z * (1 - z));
  }
  for (const double z : {0.15, 0.31, 0.5, 0.72}) EXPECT_NEAR(velocity_at(*fluid, {0.5, 0, z})[0], z * (1 - z), 1e-6);
  for (const double z : {0.0, 0.02}) EXPECT_NEAR(velocity_at(*fluid, {0.5, 0, z})[0], z * (1 - z), 0.05 * 0.05);
}

TEST_P(Turning, AProbeMovesWithAModel) {
  Scene scene;
  scene.models = {Model{}, Model{}};
  scene.models[0].name = "other", scene.models[1].name = "tank";
  Probe probe;
  probe.kind = ProbeKind::kVelocity;
  probe.at = {0.2, 0, 0.3};
  probe.frame = "tank";
  scene.probes = {probe};
  std::vector<exchange::BodyState> states(2);
  states[0].orientation[0] = 1;
  const Quat q(Eigen::AngleAxisd(0.5, Vec3::UnitY()));  // turned and shifted
  states[1] = states[0];
  states[1].position[0] = 0.1, states[1].position[2] = 0.2;
  states[1].orientation[0] = q.w(), states[1].orientation[2] = q.y();
  const Vec3 at(0.1 + 0.2 * std::cos(0.5) + 0.3 * std::sin(0.5), 0, 0.2 - 0.2 * std::sin(0.5) + 0.3 * std::cos(0.5));
  const Vec3 exact = Vec3(0.3, 0, -0.1) + Vec3(0, 2, 0).cross(at - Vec3(0.5, 0, 0.5));
  const auto row = read_probes(scene, *fluid_, states);
  ASSERT_EQ(row.size(), 3u);
  EXPECT_LT((Vec3::Map(row.data()) - exact).norm(), 1e-5);
}

TEST_P(Turning, ThereIsNoVelocityAwayFromTheFluid) {
  EXPECT_EQ(velocity_at(*fluid_, {1.4, 0, 0.5}), Vec3::Zero().eval());
}

TEST_P(Turning, VelocityAboveASingleLayerIsThatOfTheLayer) {
  // Two halves that differ in speed by 1 m/s and in height by 2 mm: no gradient over 2 mm reaches up to the probe.
  Scene scene;
  scene.world.spacing = 0.05;
  scene.world.dimension = GetParam();
  scene.numerics.sound_speed = 20;
  scene.numerics.relax = false;
  Fluid slow, fast;
  slow.name = "slow", fast.name = "fast";
  slow.fill.box = {{0, -0.5, 0}, {0.5, 0.5, 0.05}};
  fast.fill.box = {{0.5, -0.5, 0.002}, {1, 0.5, 0.052}};
  fast.velocity = {1, 0, 0};
  scene.fluids = {slow, fast};
  const auto fluid = *WcsphFluid::make(scene, *make_bodies(scene), 1);
  for (const double x : {0.44, 0.48, 0.52, 0.56}) {
    const Vec3 v = velocity_at(*fluid, {x, 0, 0.08});
    EXPECT_GT(v[0], -0.2) << x;
    EXPECT_LT(v[0], 1.2) << x;
  }
}

TEST_P(Turning, MotionIsThatOfARigidBody) {
  const double mass = 1000, turning = mass * (1 - 0.05 * 0.05) / 6;  // of a lattice of 20 x 20, about its centre
  const Vec3 momentum(0.3 * mass, 0, -0.1 * mass);
  const Vec3 angular = Vec3(0.5, 0, 0.5).cross(momentum) + Vec3(0, 2 * turning, 0);
  const auto motion = motion_of(*fluid_, 0);
  EXPECT_LT((Vec3::Map(motion.data()) - momentum).norm(), 1e-3 * momentum.norm());
  EXPECT_LT((Vec3::Map(motion.data() + 3) - angular).norm(), 1e-3 * angular.norm());
  const Vec3 corner = Vec3(0.3, 0, -0.1) + Vec3(0, 2, 0).cross(Vec3(0.475, 0, 0.475));  // the fastest one
  EXPECT_NEAR(motion[6], corner.norm(), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Turning, ::testing::Values(2, 3));

/// Water of 1 m with a box in it, and no body there: a hole of so many particles across, enclosed or open.
class Holes : public ::testing::TestWithParam<int> {
 protected:
  double void_of(double width, double middle) {
    Scene scene = water_of_a_metre(GetParam());
    if (width > 0) {
      Model hole;
      hole.name = "hole", hole.motion = Motion::kStatic;
      hole.shape.size = {width, GetParam() == 2 ? 1 : width, width};
      hole.pose.position = {0.5, 0, middle};
      scene.models = {hole};
    }
    const auto bodies = *make_bodies(scene);
    return largest_void(**WcsphFluid::make(scene, bodies, 1), 0);
  }
};

TEST_P(Holes, NoneInALattice) { EXPECT_EQ(void_of(0, 0.5), 0); }

TEST_P(Holes, AreMeasuredLessASpacingAround) {
  // Particles end half a spacing outside the box, what is within a spacing of them half a spacing inside it.
  const double side = 0.4 - 0.05, step = 0.025;
  const double exact = std::pow(side, GetParam()), rim = std::pow(side + 2 * step, GetParam()) - exact;
  EXPECT_NEAR(void_of(0.4, 0.5), exact, rim);
}

TEST_P(Holes, AreNoneIfOpen) { EXPECT_EQ(void_of(0.4, 0.9), 0); }

INSTANTIATE_TEST_SUITE_P(Dimensions, Holes, ::testing::Values(2, 3));

}  // namespace
}  // namespace ballast::fluid
