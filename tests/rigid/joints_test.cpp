// Joints against exact solutions: pendulum, chains, springs, motors, limits, and the refusal of what an engine cannot
// do.
#include <numbers>

#include "tests/rigid/conformance.h"

namespace ballast::testing {

using Joints = EveryEngine;
FOR_EVERY_ENGINE(Joints);

/// Rod of length l hanging from the origin in the plane x-z, turned by theta from hanging down.
std::uint32_t hang_rod(World& world, double mass, double l, double theta, int parent, const Vec& pivot) {
  const Vec centre = pivot + 0.5 * l * Vec(-std::sin(theta), 0, -std::cos(theta));
  const auto b = world.box(BodyMotion::kDynamic, mass, {0.05, 0.05, l}, centre);
  world[b].orientation[0] = std::cos(0.5 * theta);
  world[b].orientation[2] = std::sin(0.5 * theta);
  world.joint(JointType::kRevolute, parent, b, pivot);
  return b;
}

struct Swing {
  double period = 0, gap = 0, amplitude_loss = 0, energy_gain = 0;
};

/// Swings through four half periods and measures between the turning points' downward crossings.
Swing swing(const std::string& engine, double degrees, double dt) {
  World world(kGravity, 3, 1);
  const double l = 1, theta0 = degrees * std::numbers::pi / 180;
  const auto b = hang_rod(world, 2, l, theta0, -1, {0, 0, 0});
  Simulation run(engine, world, dt);
  const auto angle = [&] { return 2 * std::atan2(run[b].orientation[2], run[b].orientation[0]); };
  Swing result;
  std::vector<double> crossings;
  double last = theta0, top = 0, start = run.energy();
  run.to(30, [&] {
    const double now = angle();
    if (now < 0 && last >= 0 && now > -1) crossings.push_back(run.time() - dt * now / (now - last));
    last = now;
    const Vec pivot = run.position(b) + quat(run[b]) * Vec(0, 0, 0.5 * l);
    result.gap = std::max(result.gap, pivot.norm() / l);
    result.energy_gain = std::max(result.energy_gain, run.energy() - start);
    if (crossings.size() == 2) top = std::max(top, std::abs(now));
  });
  result.period = crossings.size() > 1 ? crossings[1] - crossings[0] : 0;
  result.amplitude_loss = 1 - top / theta0;
  return result;
}

// VALIDATION R4: T = 4 sqrt(I/(m g d)) K(sin(theta0/2)); the rod's section counts in I.
TEST_P(Joints, R4_PendulumPeriodIsTheEllipticIntegral) {
  World world;
  hang_rod(world, 1, 1, 0.1, -1, {0, 0, 0});
  if (!takes_joints(world)) return;
  const double inertia = (0.05 * 0.05 + 1) / 12 + 0.25, small = std::sqrt(inertia / (kGravity * 0.5));
  for (const double degrees : {5.0, 30.0, 60.0, 90.0, 150.0, 179.0}) {
    const double exact = 4 * small * std::comp_ellint_1(std::sin(degrees * std::numbers::pi / 360));
    const Swing result = swing(GetParam(), degrees, 1e-3);
    const std::string at = " at " + std::to_string(static_cast<int>(degrees)) + " deg";
    figure("R4 period error" + at, result.period / exact - 1, degrees > 170 ? "1e-2" : "1e-3");
    figure("R4 amplitude loss in two periods" + at, result.amplitude_loss, "2e-3");
    figure("R4 hinge gap / length" + at, result.gap, "1e-4");
    EXPECT_NEAR(result.period / exact, 1, degrees > 170 ? 1e-2 : 1e-5);  // near the top the period has a pole
    EXPECT_NEAR(result.amplitude_loss, 0, degrees > 170 ? 1e-3 : 1e-4);
    EXPECT_LT(result.gap, 1e-4);
  }
}

TEST_P(Joints, R4_CoarseStepsStayAccurate) {
  World world;
  hang_rod(world, 1, 1, 0.1, -1, {0, 0, 0});
  if (!takes_joints(world)) return;
  const double exact =
      4 * std::sqrt(((0.05 * 0.05 + 1) / 12 + 0.25) / (kGravity * 0.5)) * std::comp_ellint_1(std::sqrt(0.5));
  for (const double dt : {4e-3, 8e-3}) {
    const double error = swing(GetParam(), 90, dt).period / exact - 1;
    figure("R4 period error at 90 deg, dt = " + std::to_string(dt), error, "1e-3 at 1e-3");
    EXPECT_NEAR(error, 0, 1e-4);
  }
}

// VALIDATION R13: 20 ball-joint links of 0.1 m with 100 times a link's mass at the end.
TEST_P(Joints, R13_ChainWithAHeavyEndKeepsItsLength) {
  World world(kGravity, 3, 0.1);
  std::vector<std::uint32_t> links;
  const double tilt = std::numbers::pi / 3;  // below the horizontal: 30 degrees from hanging
  const Vec along(std::cos(tilt), 0, -std::sin(tilt));
  for (int i = 0; i < 20; ++i) {
    const auto b = world.box(BodyMotion::kDynamic, i == 19 ? 10 : 0.1, {0.1, 0.02, 0.02}, (0.1 * i + 0.05) * along);
    world[b].orientation[0] = std::cos(0.5 * tilt);
    world[b].orientation[2] = std::sin(0.5 * tilt);
    world.joint(JointType::kBall, i == 0 ? -1 : static_cast<int>(links.back()), b, 0.1 * i * along);
    links.push_back(b);
  }
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  const double start = run.energy(), scale = 11.9 * kGravity * 2 * (1 - std::sin(tilt));
  double gap = 0, gain = 0;
  run.to(6, [&] {
    Vec end = Vec::Zero();
    for (const auto b : links) {
      const Vec half = quat(run[b]) * Vec(0.05, 0, 0);
      gap = std::max(gap, (run.position(b) - half - end).norm() / 0.1);
      end = run.position(b) + half;
    }
    gain = std::max(gain, (run.energy() - start) / scale);
  });
  figure("R13 joint gap / link", gap, "1e-3");
  figure("R13 energy gain / swing energy", gain, "1e-2");
  figure("R13 energy at the end / swing energy", (run.energy() - start) / scale, "-");
  EXPECT_LT(gap, 1e-3);
  EXPECT_LT(gain, 1e-2);
}

TEST_P(Joints, R14_DoublePendulumKeepsItsEnergy) {
  World world(kGravity, 3, 1);
  const auto a = hang_rod(world, 1, 1, std::numbers::pi / 2, -1, {0, 0, 0});
  hang_rod(world, 1, 1, std::numbers::pi / 2, static_cast<int>(a), {-1, 0, 0});
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  const double start = run.energy(), scale = kGravity * 2;
  double worst = 0;
  run.to(10, [&] { worst = std::max(worst, std::abs(run.energy() - start) / scale); });
  figure("R14 energy drift over 10 s", worst, "1e-2");
  EXPECT_LT(worst, 1e-3);
}

/// Mass on a spring along z or a wheel on a torsion spring; returns the engine's world with one body.
World oscillator(JointType type, double stiffness, double damper) {
  World world(0);
  const auto b = world.body(BodyMotion::kDynamic, 2, {2, 2, 2}, {0, 0, 0});
  JointRecord& joint = world.joint(type, -1, b, {0, 0, 0}, Vec::UnitZ());
  joint.spring = stiffness;
  joint.damper = damper;
  joint.rest = 0.3;
  return world;
}

double coordinate(const Simulation& run, JointType type) {
  return type == JointType::kPrismatic ? run.position(0).z()
                                       : 2 * std::atan2(run[0].orientation[3], run[0].orientation[0]);
}

TEST_P(Joints, SpringAndDamperFollowTheDampedOscillator) {
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
    const double k = 2 * 100, c = 2 * 0.5 * 2, omega = 10, decay = c / 4;  // mass 2: k/m = 100, decay = c/(2m)
    const World world = oscillator(type, k, c);
    if (!takes_joints(world)) return;
    Simulation run(GetParam(), world, 1e-3);
    const double damped = std::sqrt(omega * omega - decay * decay);
    double worst = 0;
    run.to(2, [&] {
      const double t = run.time();
      const double exact =
          0.3 - 0.3 * std::exp(-decay * t) * (std::cos(damped * t) + decay / damped * std::sin(damped * t));
      worst = std::max(worst, std::abs(coordinate(run, type) - exact));
    });
    figure("spring and damper, error / amplitude", worst / 0.3, "1e-3");
    EXPECT_LT(worst / 0.3, 1e-3);
  }
}

/// The fluid sees the velocity that is reported: if the body moves by another one, the fluid loses or gains the way
/// between.
TEST_P(Joints, ASpringAgainstTheFluidMovesByTheVelocityThatIsReported) {
  const double h = 1e-3, k = 200, push = 30;
  const World world = oscillator(JointType::kPrismatic, k, 0);
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, h);
  run.wrenches[0].force[2] = push;
  double worst = 0, last = run.position(0).z(), highest = 0;
  run.to(3, [&] {
    const double z = run.position(0).z();
    worst = std::max(worst, std::abs(z - last - h * run.velocity(0).z()));
    last = z;
    highest = std::max(highest, z);
  });
  EXPECT_LT(worst, 1e-12) << "m a step";
  const double middle = 0.3 + push / k;  // swings about it from 0
  EXPECT_NEAR(highest, 2 * middle, 1e-3);
  EXPECT_NEAR(run.position(0).z(), middle * (1 - std::cos(10 * 3.0)), 6e-3 * middle) << "half a step of phase";
}

// S32 with the fluid's force. Kick and drift keep v^2 + w'^2 x^2 - w'^2 h x v with w'^2 = w^2 / (1 + (w h)^2 / 4): from
// rest the swing is sqrt(1 + (w h)^2 / 4) times as wide as it should be where a step cannot resolve it, but never
// grows.
TEST_P(Joints, StiffSpringsAreStableInTheFluid) {
  for (const double product : {0.1, 1.0, 10.0}) {
    const double k = 2 * product * product * 1e6;
    const World world = oscillator(JointType::kPrismatic, k, 0);
    if (!takes_joints(world)) return;
    Simulation run(GetParam(), world, 1e-3);
    run.wrenches[0].force[2] = 0.3 * k;
    double highest = 0;
    run.to(2, [&] { highest = std::max(highest, std::abs(run.position(0).z() - 0.6)); });
    EXPECT_LT(highest, 0.6 * std::sqrt(1 + product * product / 4) * 1.001) << "omega dt = " << product;
  }
}

// S32: omega dt from 0.1 to 10 must not blow up, with and without damping.
TEST_P(Joints, S32_StiffSpringsAreStable) {
  for (const double product : {0.1, 1.0, 10.0}) {
    for (const double ratio : {0.0, 0.1, 1.0}) {
      const double omega = product / 1e-3;
      const World world = oscillator(JointType::kPrismatic, 2 * omega * omega, 2 * ratio * omega * 2);
      if (!takes_joints(world)) return;
      Simulation run(GetParam(), world, 1e-3);
      double highest = 0;
      run.to(2, [&] { highest = std::max(highest, std::abs(run.position(0).z() - 0.3)); });
      EXPECT_LT(highest, 0.3 * 1.0001) << "omega dt = " << product << ", damping ratio " << ratio;
      if (ratio > 0) {
        EXPECT_NEAR(run.position(0).z(), 0.3, 1e-3) << "omega dt = " << product;
      }
    }
  }
}

TEST_P(Joints, MotorReachesItsSpeedAndNoMoreThanItsEffort) {
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
    World world = oscillator(type, 0, 0);
    world.manifest.joints[0].motor_velocity = 3;
    world.manifest.joints[0].motor_max_effort = 4;  // mass 2: 2 m/s^2 until 1.5 s
    if (!takes_joints(world)) return;
    Simulation run(GetParam(), world, 1e-3);
    const auto speed = [&] { return type == JointType::kPrismatic ? run.velocity(0).z() : run.spin(0).z(); };
    run.to(1);
    EXPECT_NEAR(speed(), 2, 1e-6);
    run.to(2);
    EXPECT_NEAR(speed(), 3, 1e-9);
  }
}

TEST_P(Joints, LimitsStopWithoutThrowing) {
  World world(kGravity, 3, 1);
  const auto b = hang_rod(world, 1, 1, std::numbers::pi / 2, -1, {0, 0, 0});
  world.manifest.joints[0].lower = -std::numbers::pi / 2;  // straight down: 90 degrees from the start
  world.manifest.joints[0].upper = 0.1;
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  const auto angle = [&] { return 2 * std::atan2(run[b].orientation[2], run[b].orientation[0]); };
  double lowest = 1, rebound = 0;
  bool hit = false;
  run.to(3, [&] {
    lowest = std::min(lowest, angle());
    hit = hit || angle() < 0.01;
    if (hit) rebound = std::max(rebound, angle());
  });
  figure("limit: overshoot, rad", -lowest, "0.01");
  figure("limit: rebound, rad", rebound, "0.05");
  EXPECT_GT(lowest, -0.01);
  EXPECT_LT(rebound, 0.05);
}

// A gate leaning on its stop under a steady load, as water gives it: it must neither creep nor chatter.
TEST_P(Joints, GateHeldByItsStopStandsStill) {
  World world(kGravity, 2, 0.5);
  const auto b = world.box(BodyMotion::kDynamic, 20, {0.02, 1, 0.5}, {0, 0, 0.25});
  world.joint(JointType::kRevolute, -1, b, {0, 0, 0});
  world.manifest.joints[0].upper = 0;
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  double fastest = 0, turned = 0;
  run.to(5, [&] {
    put(run.wrenches[b].force, {1226, 0, 0});  // rho g H^2/2 per metre, H = 0.5 m
    put(run.wrenches[b].torque, {0, -1226 * (0.25 - 0.5 / 3), 0});
    if (run.time() > 0.1) fastest = std::max(fastest, run.spin(b).norm());
    turned = std::max(turned, std::abs(2 * std::asin(run[b].orientation[2])));
  });
  figure("gate on its stop: spin, rad/s", fastest, "1e-6");
  figure("gate on its stop: turned, rad", turned, "1e-3");
  EXPECT_LT(fastest, 1e-6);
  EXPECT_LT(turned, 1e-3);
}

TEST_P(Joints, FixedJointHoldsAgainstAWrenchAndReportsNoMobility) {
  World world;
  const auto b = world.box(BodyMotion::kDynamic, 1, {0.1, 0.1, 0.1}, {0, 0, 0});
  world.joint(JointType::kFixed, -1, b, {0, 0, 0});
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  put(run.wrenches[b].force, {100, 50, 20});
  put(run.wrenches[b].torque, {1, 2, 3});
  run.to(1);
  run.engine().mobility(run.states);
  EXPECT_LT(run.position(b).norm(), 1e-6);
  EXPECT_LT(run.velocity(b).norm(), 1e-6);
  for (const double m : run[b].mobility) EXPECT_EQ(m, 0);
  for (const double a : run[b].free_acceleration) EXPECT_EQ(a, 0);
}

TEST_P(Joints, UniversalJointKeepsItsAxesCrossed) {
  World world(0);
  const auto b = world.body(BodyMotion::kDynamic, 1, {0.1, 0.1, 0.1}, {0, 0, -1});
  world.joint(JointType::kUniversal, -1, b, {0, 0, 0}, Vec::UnitX());
  put(world.manifest.joints[0].axis2, Vec::UnitY());
  put(world[b].angular_velocity, {1, 2, 0});
  put(world[b].velocity, Vec(1, 2, 0).cross(Vec(0, 0, -1)));
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  const double energy = run.energy();
  run.to(5);
  EXPECT_NEAR((run.position(b) + quat(run[b]) * Vec(0, 0, 1)).norm(), 0, 1e-4);
  EXPECT_NEAR((quat(run[b]) * Vec::UnitY()).x(), 0, 1e-4) << "second axis stays across the first";
  EXPECT_NEAR(run.energy() / energy, 1, 1e-3);
}

// A hinge carried by a prescribed body moves with it.
TEST_P(Joints, PrescribedBodyCarriesAHinge) {
  World world(0);
  const auto carrier = world.body(BodyMotion::kPrescribed, 0, Vec::Zero(), {0, 0, 0});
  world[carrier].drive_velocity[0] = 1;
  const auto b = world.body(BodyMotion::kDynamic, 1, {0.1, 0.1, 0.1}, {0, 0, -0.5});
  world[b].velocity[0] = 1;
  world.joint(JointType::kRevolute, static_cast<int>(carrier), b, {0, 0, 0});
  if (!takes_joints(world)) return;
  Simulation run(GetParam(), world, 1e-3);
  run.to(2);
  EXPECT_NEAR((run.position(b) - Vec(2, 0, -0.5)).norm(), 0, 1e-6);
}

TEST_P(Joints, WhatAJointCannotDoIsRefusedByName) {
  const auto refused = [&](auto spoil, const std::string& says) {
    World world(9.81, 3);
    const auto b = world.body(BodyMotion::kDynamic, 1, {1, 1, 1}, {0, 0, 0});
    spoil(world, world.joint(JointType::kRevolute, -1, b, {0, 0, 0}));
    const auto loaded = (*make_engine(GetParam()))->load(world.manifest.view());
    ASSERT_FALSE(loaded) << says;
    EXPECT_EQ(loaded.error().exit_code, kBadInput);
    EXPECT_NE(loaded.error().what.find("joint0"), std::string::npos);
    const bool lacks_all = loaded.error().what.find("no joints") != std::string::npos;
    EXPECT_TRUE(lacks_all || loaded.error().what.find(says) != std::string::npos) << loaded.error().what;
  };
  refused([](World&, JointRecord& j) { j.type = JointType::kBall, j.spring = 1; }, "ball");
  refused([](World&, JointRecord& j) { j.upper = 4; }, "half a turn");
  refused([](World&, JointRecord& j) { j.lower = 1, j.upper = -1; }, "above its upper");
  refused([](World&, JointRecord& j) { j.child = 7; }, "body 7");
  refused([](World& w, JointRecord& j) { w.manifest.world.dimension = 2, put(j.axis, Vec::UnitX()); }, "plane x-z");
}

TEST_P(Joints, PlanePendulumEqualsTheOneInSpace) {
  World flat(kGravity, 2, 1), space(kGravity, 3, 1);
  const auto a = hang_rod(flat, 2, 1, 1, -1, {0, 0, 0}), b = hang_rod(space, 2, 1, 1, -1, {0, 0, 0});
  if (!takes_joints(flat)) return;
  Simulation in_plane(GetParam(), flat, 1e-3), in_space(GetParam(), space, 1e-3);
  in_plane.to(3);
  in_space.to(3);
  EXPECT_NEAR((in_plane.position(a) - in_space.position(b)).norm(), 0, 1e-6);
}

}  // namespace ballast::testing
