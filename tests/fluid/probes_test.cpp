// Probes of a field that is known: water that turns as a rigid body.
#include "fluid_server/probes/probes.h"

#include <gtest/gtest.h>

#include "common/geometry/bodies.h"

namespace ballast::fluid {
namespace {

class Turning : public testing::TestWithParam<int> {
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

TEST_P(Turning, ThereIsNoVelocityAwayFromTheFluid) {
  EXPECT_EQ(velocity_at(*fluid_, {1.4, 0, 0.5}), Vec3::Zero().eval());
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Turning, testing::Values(2, 3));

}  // namespace
}  // namespace ballast::fluid
