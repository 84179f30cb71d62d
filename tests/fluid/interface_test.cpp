// The interface residual and its iteration with a fluid and an engine that are formulas: a fluid of which each body
// drags its added mass along, w = f - A a with the acceleration a that the fluid foresees, and joints between points.
#include "fluid_server/step/interface.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "fluid_server/boundary/samples.h"

namespace ballast::fluid {
namespace {

/// Spheres of 1 m^3 in water, with the inertia of a sphere.
struct Bodies {
  Bodies(std::vector<double> masses, double gravity, const char* scheme) : mass(std::move(masses)), g(gravity) {
    scene.world.gravity = Vec3(0, 0, -g);
    scene.world.spacing = 0.1;
    scene.coupling.scheme = scheme;
    scene.coupling.tolerance = 1e-6;
    scene.fluids.resize(1);
    for (std::size_t b = 0; b < mass.size(); ++b) {
      Model model;
      model.name = "b" + std::to_string(b);
      model.shape.kind = ShapeKind::kSphere;
      model.shape.radius = std::cbrt(3 / (4 * M_PI));
      model.mass = mass[b];
      scene.models.push_back(model);
    }
    bodies = *make_bodies(scene);
    states.resize(mass.size());
    for (std::size_t b = 0; b < mass.size(); ++b) {
      exchange::BodyState& s = states[b];
      s.free_acceleration[2] = -g;
      for (int k = 0; k < 3; ++k) s.mobility[7 * k] = 1 / mass[b], s.mobility[7 * (3 + k)] = 1 / (0.1 * mass[b]);
    }
  }
  /// w = f - A a, and the foreseen a = (1 + K A)^-1 (a0 + K f): added mass of half, buoyancy of all the water
  /// displaced.
  std::vector<exchange::Wrench> fluid(std::span<const exchange::BodyState> assumed) const {
    std::vector<exchange::Wrench> wrenches(mass.size());
    for (std::size_t b = 0; b < mass.size(); ++b) {
      const Vec3 f(0, 0, 1000 * g), a0 = Vec3::Map(assumed[b].free_acceleration);
      const Vec3 a = (a0 + f / mass[b]) / (1 + kAdded / mass[b]);
      Vec3::Map(wrenches[b].force) = f - kAdded * a;
    }
    return wrenches;
  }
  /// All bodies move as one along `axis`; others of length zero: freely.
  std::vector<exchange::BodyState> engine(const std::vector<exchange::Wrench>& wrenches, const Vec3& axis) const {
    std::vector<exchange::BodyState> moved = states;
    Vec3 total = Vec3::Zero();
    double whole = 0;
    for (std::size_t b = 0; b < mass.size(); ++b)
      total += Vec3::Map(wrenches[b].force) - Vec3(0, 0, mass[b] * g), whole += mass[b];
    for (std::size_t b = 0; b < mass.size(); ++b) {
      const Vec3 alone = Vec3::Map(wrenches[b].force) / mass[b] - Vec3(0, 0, g);
      Vec3::Map(moved[b].acceleration) = axis.isZero(0) ? alone : Vec3(axis * axis.dot(total / whole));
    }
    return moved;
  }
  /// Exchanges until the interface is settled; their number.
  int run(Interface& interface, const Vec3& axis) {
    interface.begin(states);
    for (int k = 1;; ++k) {
      const auto wrenches = fluid(interface.assumed());
      after = engine(wrenches, axis);
      if (interface.settle(wrenches, after)) return interface.keep(), k;
    }
  }
  Interface interface() const { return Interface(scene, bodies, true); }

  static constexpr double kAdded = 500;
  std::vector<double> mass;
  double g;
  Scene scene;
  std::vector<Body> bodies;
  std::vector<exchange::BodyState> states, after;
};

/// A body that water reaches only in a repetition: what a step gives hangs on no earlier step (a resumed run has none).
TEST(Interface, StepsHaveNoHistory) {
  Bodies bodies({2000, 3000}, 9.81, "iterated");
  bodies.states[1].free_acceleration[4] = 2;
  const auto step = [&](Interface& interface) {
    interface.begin(bodies.states);
    for (int k = 0; k < 3; ++k) {
      auto wrenches = bodies.fluid(interface.assumed());
      auto after = bodies.engine(wrenches, Vec3::UnitX());
      if (k == 0) wrenches[1] = {};
      after[1].acceleration[4] = 0.5 * k;
      EXPECT_FALSE(interface.settle(wrenches, after));
    }
    std::vector<double> found;
    for (const exchange::BodyState& s : interface.assumed())
      found.insert(found.end(), s.free_acceleration, s.free_acceleration + 6);
    return found;
  };
  Interface fresh = bodies.interface(), old = bodies.interface();
  bodies.run(old, Vec3::UnitX());
  EXPECT_EQ(step(fresh), step(old));
}

TEST(Interface, AFreeBodyHasNoResidualHoweverLight) {
  Bodies bodies({1, 500, 8000}, 9.81, "iterated");
  Interface interface = bodies.interface();
  EXPECT_EQ(bodies.run(interface, Vec3::Zero()), 1);
  EXPECT_LT(interface.report().most, 1e-12);
  EXPECT_NEAR(bodies.after[0].acceleration[2], 9.81 * (1000 - 1) / (1 + 500), 1e-9);
}

/// a = g (displaced - masses) / (masses + added masses); a light body on its own would be thrown up at 2 g.
TEST(Interface, JoinedBodiesMoveWithTheAddedMassOfAll) {
  Bodies bodies({10, 4000}, 9.81, "iterated");
  Interface interface = bodies.interface();
  const int taken = bodies.run(interface, Vec3::UnitZ());
  EXPECT_LE(taken, 4) << "two unknowns that matter";
  EXPECT_NEAR(bodies.after[0].acceleration[2], 9.81 * (2000 - 4010) / (4010 + 2 * Bodies::kAdded), 1e-5);
  EXPECT_EQ(interface.report().iterations, std::uint64_t(taken));
  EXPECT_EQ(interface.report().unreached, 0u);
}

TEST(Interface, ABodyOnARailMovesAlongItOnly) {
  Bodies bodies({10}, 9.81, "iterated");
  Interface interface = bodies.interface();
  bodies.run(interface, Vec3(1, 0, 1).normalized());
  const double along = 9.81 * std::sqrt(0.5) * (1000 - 10) / (10 + Bodies::kAdded);
  EXPECT_NEAR(bodies.after[0].acceleration[0], along * std::sqrt(0.5), 1e-5);
  EXPECT_NEAR(bodies.after[0].acceleration[2], along * std::sqrt(0.5), 1e-5);
}

/// The same motion on another planet, of other masses, or in other units of time: the same number.
TEST(Interface, TheResidualHasNoUnits) {
  double first = 0;
  for (const double g : {9.81, 1.62, 1e-3}) {
    Bodies bodies({10, 4000}, g, "interlinked");
    Interface interface = bodies.interface();
    EXPECT_EQ(bodies.run(interface, Vec3::UnitZ()), 1) << "only measured";
    if (first == 0) first = interface.report().most;
    EXPECT_NEAR(interface.report().most, first, 1e-9 * first);
  }
  EXPECT_GT(first, 1) << "foreseen at 1.9 g upwards, found falling at 0.4 g";
}

TEST(Interface, WhatIsNotReachedIsCountedAndNotHidden) {
  Bodies bodies({10, 4000}, 9.81, "iterated");
  bodies.scene.coupling.most_iterations = 2;
  Interface interface = bodies.interface();
  EXPECT_EQ(bodies.run(interface, Vec3::UnitZ()), 2);
  EXPECT_EQ(interface.report().unreached, 1u);
  EXPECT_GT(interface.report().last, 1e-6);
}

/// A dry body may do what it wants: the fluid foresees nothing of it.
TEST(Interface, BodiesThatTheFluidDoesNotTouchDoNotCount) {
  Bodies bodies({10}, 9.81, "iterated");
  Interface interface = bodies.interface();
  interface.begin(bodies.states);
  std::vector<exchange::BodyState> after = bodies.states;
  after[0].acceleration[0] = 100;
  EXPECT_TRUE(interface.settle(std::vector<exchange::Wrench>(1), after));
  interface.keep();
  EXPECT_EQ(interface.report().steps, 0u);
}

}  // namespace
}  // namespace ballast::fluid
