// The barrier: no particle passes a surface, whatever drives it, and what stops it is taken from the solids.
#include "fluid_server/boundary/barrier.h"

#include <gtest/gtest.h>

#include "fluid_server/step/wcsph.h"
#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

constexpr double kSpacing = 0.05, kDt = 1e-3;

/// Water one particle deep, 0.4 spacings above the floor of a tank and thrown down at 30 m/s, almost without pressure;
/// right above it a plate of the given density that comes down too.
struct Squeeze {
  explicit Squeeze(double density) {
    scene.world.spacing = kSpacing;
    scene.models = {tank({0.6, 0.6, 0.6})};
    if (density > 0) {
      Model plate = box_body("plate", {0.4, 0.4, 0.2}, density, {0.3, 0.3, 0.6 * kSpacing + 0.1});
      plate.velocity = {0, 0, -60};
      scene.models.push_back(plate);
    }
    Fluid water;
    water.fill.box = {{0.15, 0.15, -0.2 * kSpacing}, {0.45, 0.45, 0.8 * kSpacing}};
    water.velocity = {0, 0, -30};
    scene.fluids = {water};
    scene.numerics.relax = false;
    scene.numerics.sound_speed = 1;
    scene.world.allow_overlap = true;
    bodies = *make_bodies(scene);
    fluid = *WcsphFluid::make(scene, bodies, 2);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      states.push_back(initial_state(scene.models[b], bodies[b], scene.world.gravity));
      if (bodies[b].mass == 0) continue;
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> mobility(states[b].mobility);
      mobility.setZero();
      mobility.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / bodies[b].mass;
      mobility.bottomRightCorner<3, 3>() = bodies[b].inertia.inverse();
      Vec3::Map(states[b].free_acceleration) = scene.world.gravity;
    }
  }
  double lowest() const {
    double z = 1;
    for (const Record& r : fluid->particles().record) z = std::min(z, fluid->coordinates().to_metres(r.x, r.y, r.z)[2]);
    return z;
  }
  double highest() const {
    double z = -1;
    for (const Record& r : fluid->particles().record) z = std::max(z, fluid->coordinates().to_metres(r.x, r.y, r.z)[2]);
    return z;
  }
  /// After the step, with the velocity that the wrench gives it.
  double bottom_of_plate() const {
    const double velocity =
        scene.models[1].velocity[2] + kDt * (scene.world.gravity[2] + fluid->wrenches()[1].force[2] / bodies[1].mass);
    return scene.models[1].pose.position[2] - 0.1 + kDt * velocity;
  }
  Scene scene;
  std::vector<Body> bodies;
  std::unique_ptr<WcsphFluid> fluid;
  std::vector<exchange::BodyState> states;
};

TEST(Barrier, StopsWhatWouldPassTheFloorAndHandsItsMomentumOn) {
  Squeeze squeeze(0);
  const Measures before = squeeze.fluid->measure();
  squeeze.fluid->begin(squeeze.states, kDt);
  squeeze.fluid->move();
  EXPECT_GE(squeeze.lowest(), -1e-6);  // 30 m/s for 1 ms is 30 mm, from 20 mm above the floor
  EXPECT_EQ(squeeze.fluid->barrier().pushes, squeeze.fluid->particles().size());
  const Vec3 given = kDt * Vec3::Map(squeeze.fluid->wrenches()[0].force);
  const Vec3 gained =
      squeeze.fluid->measure().momentum - before.momentum - kDt * before.mass * squeeze.scene.world.gravity;
  EXPECT_LT((given + gained).norm(), 1e-5 * given.norm());
}

class SqueezeBy : public ::testing::TestWithParam<double> {};

TEST_P(SqueezeBy, APlateOfAnyDensityConservesMomentumAndLeavesNoParticleInASolid) {
  Squeeze squeeze(GetParam());
  const Measures before = squeeze.fluid->measure();
  squeeze.fluid->begin(squeeze.states, kDt);
  squeeze.fluid->move();
  EXPECT_GE(squeeze.lowest(), -1e-6);
  if (GetParam() <= 100) {  // heavier ones do not notice single particles: they may sink in for a step
    EXPECT_LE(squeeze.highest(), squeeze.bottom_of_plate() + 0.05 * kSpacing);
  }
  EXPECT_GT(squeeze.fluid->barrier().pushes, 0u);
  const Vec3 to_tank = kDt * Vec3::Map(squeeze.fluid->wrenches()[0].force);
  const Vec3 to_plate = kDt * Vec3::Map(squeeze.fluid->wrenches()[1].force);
  const Vec3 gained =
      squeeze.fluid->measure().momentum - before.momentum - kDt * before.mass * squeeze.scene.world.gravity;
  EXPECT_LT((to_tank + to_plate + gained).norm(), 1e-5 * to_tank.norm());
  // an inelastic contact takes no more than the speed at which the plate comes
  EXPECT_LT(to_plate[2], 1.5 * 60 * (squeeze.bodies[1].mass + before.mass));
}

INSTANTIATE_TEST_SUITE_P(Density, SqueezeBy, ::testing::Values(1, 100, 1000, 8000));

}  // namespace
}  // namespace ballast::fluid
