// The balance of energy against formulas: free fall, work on a body, what leaves, what is changed from outside.
#include "fluid_server/step/energy.h"

#include <gtest/gtest.h>

#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

constexpr double kG = 9.81, kMass = 1000 * 0.4 * 0.4;  // of the block of water, kg per metre of depth

struct Energy : ::testing::Test {
  Scene scene;
  std::vector<Body> bodies;
  std::unique_ptr<WcsphFluid> fluid;
  std::unique_ptr<EnergyBalance> energy;
  std::vector<exchange::BodyState> states;

  Energy() {
    scene.world.dimension = 2;
    scene.world.spacing = 0.02;
    scene.world.domain = Box3{{-1, -1, 0}, {1, 1, 1}};
    Fluid water;
    water.fill.box = {{-0.2, -0.5, 0.5}, {0.2, 0.5, 0.9}};
    scene.fluids.push_back(water);
  }
  void make() {
    auto solid = make_bodies(scene);
    ASSERT_TRUE(solid) << solid.error().text();
    bodies = std::move(*solid);
    auto made = WcsphFluid::make(scene, bodies, 1);
    ASSERT_TRUE(made) << made.error().text();
    fluid = std::move(*made);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      states.push_back(initial_state(scene.models[b], bodies[b], scene.world.gravity));
    fluid->quiet_start(states);
    energy = std::make_unique<EnergyBalance>(scene, bodies, *fluid);
    energy->start(fluid->measure());
  }
  void step(double dt) {
    fluid->begin(states, dt);
    fluid->move();
    energy->step(states, states, dt);
    energy->measure(fluid->measure());
  }
};

/// Steps that take the new velocity for the way fall by g dt^2 n (n + 1) / 2 and lose m g^2 dt^2 n / 2.
TEST_F(Energy, OfAFreeFallIsThatOfItsSteps) {
  make();
  const double dt = 1e-3;
  for (int n = 1; n <= 50; ++n) {
    step(dt);
    EXPECT_NEAR(energy->gain(), -0.5 * kMass * kG * kG * dt * dt * n, 2e-6 * kMass * kG * 0.4) << n;
  }
  EXPECT_NEAR(energy->reference(), kMass * kG * 0.19 + 0.5 * kMass * kG * kG * 0.05 * 0.05, 0.01 * kMass * kG * 0.19)
      << "all in the lowest layer of particles, and the speed of the fall";
  EXPECT_LT(energy->share(), 1e-5);
}

/// What leaves takes its energy along: nothing is gained by it, though the potential energy of what is left rises.
TEST_F(Energy, ThatLeavesTheDomainIsNotGainedNorLost) {
  scene.world.gravity = {0, 0, -kG};
  scene.world.domain->min.z() = 0.3;  // below the zero of the potential energy for some of the way
  scene.world.domain->max.z() = 1.2;
  make();
  const double dt = 5e-4;
  int n = 0;
  for (; fluid->lost() < 300; ++n) {
    ASSERT_LT(n, 2000);
    step(dt);
  }
  EXPECT_NEAR(energy->gain(), -0.5 * kMass * kG * kG * dt * dt * n, 0.01 * kMass * kG * 0.4);
  EXPECT_GT(fluid->energy_lost(), 0.5 * kMass * kG * 0.3) << "this test had no power";
}

TEST_F(Energy, GivenToABodyIsForceTimesWay) {
  scene.world.domain->min.z() = -1;
  scene.models = {tank({0.4, 1, 0.6}, {-0.2, -0.5, 0.5}), box_body("box", {0.1, 1, 0.1}, 500, {0.03, 0, 0.7})};
  make();
  const double dt = 1e-4;
  fluid->begin(states, dt);
  const exchange::Wrench wrench = fluid->wrenches()[1];
  EXPECT_GT(wrench.force[2], 10) << "this test had no power: the box is hardly lifted";
  auto after = states;
  const double vx = 0.3, vz = 2, w = 5;
  after[1].velocity[0] = vx, after[1].velocity[2] = vz, after[1].angular_velocity[1] = w;
  after[0].velocity[2] = 7;  // a static body has no way, whatever is said of it
  energy->step(states, after, dt);
  EXPECT_NEAR(energy->work(), 0.5 * dt * (wrench.force[0] * vx + wrench.force[2] * vz + wrench.torque[1] * w), 1e-15);
}

TEST_F(Energy, OfAnotherGravityIsNoGain) {
  make();
  step(1e-3);
  const double gain = energy->gain();
  const Measures before = fluid->measure();
  scene.world.gravity = {0, 0, -20 * kG};
  fluid->set_gravity(scene.world.gravity);
  energy->jump(before, fluid->measure());
  energy->measure(fluid->measure());
  EXPECT_NEAR(energy->gain(), gain, 1e-9 * kMass * kG);
  EXPECT_NEAR(energy->reference(), 20 * kMass * kG * 0.19, 0.02 * 20 * kMass * kG * 0.19);
}

TEST_F(Energy, IsSeenWhereItComesFromNowhere) {
  scene.world.gravity = Vec3::Zero();
  scene.fluids[0].velocity = {1, 0, 0};
  make();
  Measures now = fluid->measure();
  now.kinetic *= 1.25;  // as a bad step might
  energy->measure(now);
  EXPECT_NEAR(energy->gain(), 0.25 * 0.5 * kMass, 1e-3);
  EXPECT_NEAR(energy->share(), 0.2, 1e-6) << "a quarter of 1 over 1.25";
  energy->measure(fluid->measure());
  EXPECT_NEAR(energy->share_now(), 0, 1e-6);
  EXPECT_NEAR(energy->share(), 0.2, 1e-6) << "the largest stays";
}

TEST_F(Energy, OfNothingThatMovesIsNoShare) {
  scene.world.gravity = Vec3::Zero();
  make();
  Measures now = fluid->measure();
  now.kinetic += 1e-9;  // of rounding; nothing else is at play
  energy->measure(now);
  EXPECT_LT(energy->share(), 1e-6);
}

TEST_F(Energy, HasNoBoundWhereGravityDrivesAPeriodicFluid) {
  scene.world.periodic = {true, false, false};
  make();
  EXPECT_EQ(energy->left_out(), "");
  scene.world.gravity = {1, 0, 0};
  EXPECT_NE(EnergyBalance(scene, bodies, *fluid).left_out().find("along x"), std::string::npos);
}

}  // namespace
}  // namespace ballast::fluid
