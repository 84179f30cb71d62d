// Bodies that touch nothing: exact motion, Euler's equations, prescribed motion, refusal of bad records.
#include <numbers>

#include "tests/rigid/conformance.h"

namespace ballast::testing {

using FreeFlight = EveryEngine;
FOR_EVERY_ENGINE(FreeFlight);

TEST_P(FreeFlight, R1_StraightFlightWithSpinIsExact) {
  World world(0);
  const auto b = world.box(BodyMotion::kDynamic, 2, {0.1, 0.2, 0.3}, {0, 0, 0});
  world[b].velocity[0] = 1;
  world[b].angular_velocity[2] = 1;
  Simulation run(GetParam(), world, 1e-3);
  run.to(10);
  const double angle = 2 * std::atan2(run[b].orientation[3], run[b].orientation[0]);
  const double turned = std::remainder(angle - 10, 2 * std::numbers::pi);
  figure("R1 position error after 10 s, m", (run.position(b) - Vec(10, 0, 0)).norm(), "1e-9");
  EXPECT_LT((run.position(b) - Vec(10, 0, 0)).norm(), 1e-9);
  EXPECT_NEAR(turned, 0, 1e-9);
}

TEST_P(FreeFlight, R2_ProjectileFollowsTheParabola) {
  World world;
  const auto b = world.sphere(1, 0.05, {0, 0, 0});
  put(world[b].velocity, {3, 0, 4});
  Simulation run(GetParam(), world, 1e-3);
  run.to(1);
  const double error = (run.position(b) - Vec(3, 0, 4 - 0.5 * 9.81)).norm();
  figure("R2 position error at 1 s, m", error, "1e-6");
  EXPECT_LT(error, 1e-6);
  EXPECT_NEAR(run[b].acceleration[2], -9.81, 1e-9);
}

TEST_P(FreeFlight, ConstantWrenchGivesNewtonsVelocity) {
  World world;
  const auto b = world.box(BodyMotion::kDynamic, 2, {0.1, 0.1, 0.1}, {0, 0, 0});
  Simulation run(GetParam(), world, 1e-3);
  put(run.wrenches[b].force, {1, 2, 3});
  put(run.wrenches[b].torque, {0, 0, 1e-3});
  run.to(1);
  EXPECT_NEAR((run.velocity(b) - Vec(0.5, 1, 1.5 - 9.81)).norm(), 0, 1e-9);
  EXPECT_NEAR(run.spin(b).z(), 1e-3 / (2.0 / 12 * 0.02), 1e-9);
}

// Buoyancy is a wrench that depends on position, computed at the start of the step: over 100 periods it must not pump
// energy.
TEST_P(FreeFlight, PositionDependentWrenchDoesNotPumpEnergy) {
  World world;
  const auto b = world.sphere(1, 0.05, {0, 0, 0.01});
  Simulation run(GetParam(), world, 1e-3);
  const double stiffness = 4 * std::numbers::pi * std::numbers::pi;
  double highest = 0;
  run.to(100, [&] {
    run.wrenches[b].force[2] = 9.81 - stiffness * run.position(b).z();
    if (run.time() > 98) highest = std::max(highest, std::abs(run.position(b).z()));
  });
  EXPECT_NEAR(highest, 0.01, 2e-4) << "the first step falls freely and the scheme is first order: 2 % of freedom";
}

// VALIDATION R3: sign changes of the middle spin from Jacobi's elliptic functions (free_body_intermediate_axis.csv).
TEST_P(FreeFlight, R3_IntermediateAxisFlipsOnTime) {
  World world(0);
  const auto b = world.body(BodyMotion::kDynamic, 1, {1, 2, 3}, {0, 0, 0});
  put(world[b].angular_velocity, {0.01, 1, 0});
  Simulation run(GetParam(), world, 1e-3);
  const double exact[] = {10.377305, 31.131915, 51.886524, 72.641134, 93.395744};
  const Vec momentum = run.inertia(b) * run.spin(b);
  const double energy = run.energy();
  std::vector<double> flips;
  double last = 1;
  run.to(100, [&] {
    const double w2 = (quat(run[b]).conjugate() * run.spin(b)).y();
    if (w2 * last < 0) flips.push_back(run.time() - 1e-3 * w2 / (w2 - last));
    last = w2;
  });
  ASSERT_EQ(flips.size(), 5u);
  figure("R3 first flip, error s", flips[0] - exact[0], "0.1");
  figure("R3 fifth flip, error s", flips[4] - exact[4], "1");
  figure("R3 energy drift over 100 s", run.energy() / energy - 1, "1e-3");
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(flips[i], exact[i], 1e-4);
  EXPECT_NEAR(run.energy() / energy, 1, 1e-9);
  EXPECT_NEAR((run.inertia(b) * run.spin(b) - momentum).norm() / momentum.norm(), 0, 1e-9);
}

TEST_P(FreeFlight, R15_FastSpinKeepsEnergyAndStaysFinite) {
  for (const double dt : {1e-6, 1e-3}) {
    World world(0);
    const auto b = world.body(BodyMotion::kDynamic, 1, {1, 2, 3}, {0, 0, 0});
    put(world[b].angular_velocity, Vec(1, 1, 1).normalized() * 1e4);
    Simulation run(GetParam(), world, dt);
    const double energy = run.energy();
    run.to(dt < 1e-4 ? 0.05 : 1);
    figure("R15 energy drift at dt = " + std::to_string(dt), run.energy() / energy - 1, "1e-6 in 1 s");
    EXPECT_NEAR(run.energy() / energy, 1, dt < 1e-4 ? 1e-9 : 1e-3);
  }
}

TEST_P(FreeFlight, PrescribedGateMovesAsItsFormula) {
  World world;
  const auto gate = world.box(BodyMotion::kPrescribed, 0, {0.1, 1, 1}, {1, 0, 0.5});
  BodyRecord& r = world[gate];
  r.drive_velocity[2] = 2;
  r.drive_amplitude[0] = 0.1;
  r.drive_frequency = 2;
  r.drive_angular_velocity[1] = 0.5;
  r.drive_start = 0.2;
  r.drive_stop = 0.7;
  Simulation run(GetParam(), world, 1e-3);
  run.to(0.1);
  EXPECT_EQ(run.position(gate), Vec(1, 0, 0.5));
  EXPECT_EQ(run.velocity(gate), Vec(0, 0, 0));
  run.to(0.5);
  const double phase = 2 * std::numbers::pi * 2;
  EXPECT_NEAR((run.position(gate) - Vec(1 + 0.1 * std::sin(phase * 0.3), 0, 0.5 + 0.6)).norm(), 0, 1e-12);
  EXPECT_NEAR((run.velocity(gate) - Vec(0.1 * phase * std::cos(phase * 0.3), 0, 2)).norm(), 0, 1e-9);
  EXPECT_NEAR(2 * std::asin(run[gate].orientation[2]), 0.5 * 0.3, 1e-12);
  run.to(1);
  EXPECT_NEAR(run.position(gate).z(), 0.5 + 2 * 0.5, 1e-12);
  EXPECT_EQ(run.velocity(gate), Vec(0, 0, 0));
  run.engine().mobility(run.states);
  for (const double m : run[gate].mobility) EXPECT_EQ(m, 0);
}

/// A tank let go at the end of its way: x = A (cos(w t) - 1), from rest.
TEST_P(FreeFlight, AQuarterTurnOfPhaseStartsAtRest) {
  World world;
  const auto tank = world.box(BodyMotion::kPrescribed, 0, {0.1, 1, 1}, {1, 0, 0.5});
  BodyRecord& r = world[tank];
  r.drive_amplitude[0] = 0.1;
  r.drive_frequency = 2;
  r.drive_phase = std::numbers::pi / 2;
  Simulation run(GetParam(), world, 1e-3);
  EXPECT_NEAR(run.velocity(tank).norm(), 0, 1e-12);
  EXPECT_EQ(run.position(tank), Vec(1, 0, 0.5));
  run.to(0.3);
  const double rate = 2 * std::numbers::pi * 2;
  EXPECT_NEAR(run.position(tank).x(), 1 + 0.1 * (std::cos(rate * 0.3) - 1), 1e-12);
  EXPECT_NEAR(run.velocity(tank).x(), -0.1 * rate * std::sin(rate * 0.3), 1e-9);
}

TEST_P(FreeFlight, MobilityIsTheInverseInertiaInTheWorld) {
  World world;
  const auto b = world.body(BodyMotion::kDynamic, 4, {1, 2, 3}, {0, 0, 0});
  put(world[b].angular_velocity, {0.3, 0.4, 0.5});
  Simulation run(GetParam(), world, 1e-3);
  run.to(0.5);
  run.engine().mobility(run.states);
  const Eigen::Matrix3d inverse = run.inertia(b).inverse();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double exact = i < 3 && j < 3 ? (i == j ? 0.25 : 0) : i >= 3 && j >= 3 ? inverse(i - 3, j - 3) : 0;
      EXPECT_NEAR(run[b].mobility[6 * i + j], exact, 1e-12);
    }
  }
  const Vec w = run.spin(b), gyro = -(inverse * w.cross(run.inertia(b) * w));
  EXPECT_NEAR((vec(run[b].free_acceleration) - Vec(0, 0, -9.81)).norm(), 0, 1e-12);
  EXPECT_NEAR((vec(run[b].free_acceleration + 3) - gyro).norm(), 0, 1e-12);
}

TEST_P(FreeFlight, PlaneMotionIsConfined) {
  World world(9.81, 2);
  const auto b = world.box(BodyMotion::kDynamic, 2, {0.1, 1, 0.3}, {0, 0, 0});
  put(world[b].velocity, {1, 5, 0});
  put(world[b].angular_velocity, {1, 2, 3});
  Simulation run(GetParam(), world, 1e-3);
  put(run.wrenches[b].force, {1, 7, 2});
  put(run.wrenches[b].torque, {5, 0.1, 6});
  run.to(1);
  run.engine().mobility(run.states);
  EXPECT_EQ(run.position(b).y(), 0);
  EXPECT_EQ(run.velocity(b).y(), 0);
  EXPECT_EQ(run.spin(b).x(), 0);
  EXPECT_EQ(run.spin(b).z(), 0);
  EXPECT_EQ(run[b].orientation[1], 0);
  EXPECT_EQ(run[b].orientation[3], 0);
  const double inertia = 2.0 / 12 * 0.1;
  EXPECT_NEAR(run.spin(b).y(), 2 + 0.1 / inertia, 1e-9);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double exact = i == j ? (i == 0 || i == 2 ? 0.5 : i == 4 ? 1 / inertia : 0) : 0;
      EXPECT_NEAR(run[b].mobility[6 * i + j], exact, 1e-12);
    }
  }
}

struct BadRecord {
  const char* name;
  void (*spoil)(BodyRecord&);
  const char* says;
};

TEST_P(FreeFlight, BadRecordsAreRefusedByName) {
  const BadRecord cases[] = {
      {"negative mass", [](BodyRecord& r) { r.mass = -1; }, "mass is -1"},
      {"no inertia", [](BodyRecord& r) { r.inertia[1] = 0; }, "moment of inertia"},
      {"position", [](BodyRecord& r) { r.position[0] = std::nan(""); }, "not a finite number"},
      {"orientation", [](BodyRecord& r) { r.orientation[0] = 2; }, "orientation has length 2"},
      {"restitution", [](BodyRecord& r) { r.restitution = 1.5; }, "restitution 1.5"},
  };
  for (const BadRecord& bad : cases) {
    World world;
    const auto b = world.box(BodyMotion::kDynamic, 1, {0.1, 0.1, 0.1}, {0, 0, 0});
    bad.spoil(world[b]);
    const auto loaded = (*make_engine(GetParam()))->load(world.manifest.view());
    ASSERT_FALSE(loaded) << bad.name;
    EXPECT_EQ(loaded.error().exit_code, kBadInput);
    EXPECT_NE(loaded.error().what.find(bad.says), std::string::npos) << loaded.error().what;
    EXPECT_NE(loaded.error().what.find("body0"), std::string::npos) << loaded.error().what;
  }
}

TEST_P(FreeFlight, DivergedBodyIsNamed) {
  World world;
  const auto b = world.box(BodyMotion::kDynamic, 1, {0.1, 0.1, 0.1}, {0, 0, 0});
  Simulation run(GetParam(), world, 1e-3);
  put(run.wrenches[b].force, {1e12, 0, 0});
  run.engine().apply(run.wrenches);
  const auto stepped = run.engine().step(0, 1e-3);
  ASSERT_FALSE(stepped);
  EXPECT_EQ(stepped.error().exit_code, kDiverged);
  EXPECT_NE(stepped.error().what.find("body0"), std::string::npos);
}

TEST(Engines, UnknownNameListsTheKnownOnes) {
  const auto made = make_engine("warp");
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().what.find("warp"), std::string::npos);
  for (const auto& name : engine_names()) EXPECT_NE(made.error().cure.find(name), std::string::npos);
}

}  // namespace ballast::testing
