// Small worlds for tests of rigid engines: bodies, shapes and joints in a line each, and a runner with energy and
// momentum.
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/exchange/manifest.h"
#include "rigid_client/engine.h"

namespace ballast::testing {

using Vec = Eigen::Vector3d;
using exchange::BodyMotion;
using exchange::BodyRecord;
using exchange::BodyState;
using exchange::JointRecord;
using exchange::JointType;
using exchange::Manifest;
using exchange::ShapeRecord;
using exchange::ShapeType;
using exchange::Wrench;

inline constexpr double kGravity = 9.81;  // m/s^2

inline Vec vec(const double* p) { return {p[0], p[1], p[2]}; }
inline void put(double* p, const Vec& v) { p[0] = v.x(), p[1] = v.y(), p[2] = v.z(); }
inline Eigen::Quaterniond quat(const BodyState& s) {
  return {s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]};
}

/// Builds a manifest. Sizes in m; mass and inertia of dynamic bodies follow from shape and mass.
struct World {
  Manifest manifest;

  explicit World(double gravity = 9.81, std::uint32_t dimension = 3, double length = 0.1) {
    manifest.world = {{0, 0, -gravity}, 10, 1e-3, length, dimension, 1, 7, 0.01, 0, 0};
  }

  std::uint32_t body(BodyMotion motion, double mass, const Vec& inertia, const Vec& position, double friction = 0.3,
                     double restitution = 0) {
    BodyRecord r{};
    std::snprintf(r.name, sizeof r.name, "body%zu", manifest.bodies.size());
    r.mass = mass;
    put(r.inertia, inertia);
    put(r.position, position);
    r.orientation[0] = 1;
    r.friction = friction;
    r.restitution = restitution;
    r.drive_stop = 1e300;
    r.motion = motion;
    r.first_shape = static_cast<std::uint32_t>(manifest.shapes.size());
    manifest.bodies.push_back(r);
    return static_cast<std::uint32_t>(manifest.bodies.size() - 1);
  }

  ShapeRecord& shape(std::uint32_t body, ShapeType type) {
    ShapeRecord s{};
    s.type = type;
    s.body = body;
    s.orientation[0] = 1;
    s.normal[2] = 1;
    manifest.shapes.push_back(s);
    ++manifest.bodies[body].shape_count;
    return manifest.shapes.back();
  }

  std::uint32_t box(BodyMotion motion, double mass, const Vec& size, const Vec& position, double friction = 0.3,
                    double restitution = 0) {
    const Vec sq = size.cwiseProduct(size);
    const bool flat = manifest.world.dimension == 2;
    const Vec inertia = mass / 12 * Vec(flat ? 0 : sq.y() + sq.z(), sq.x() + sq.z(), flat ? 0 : sq.x() + sq.y());
    const auto b = body(motion, mass, inertia, position, friction, restitution);
    put(shape(b, ShapeType::kBox).size, size);
    return b;
  }

  std::uint32_t sphere(double mass, double radius, const Vec& position, double friction = 0.3, double restitution = 0) {
    const auto b =
        body(BodyMotion::kDynamic, mass, Vec::Constant(0.4 * mass * radius * radius), position, friction, restitution);
    shape(b, ShapeType::kSphere).radius = radius;
    return b;
  }

  /// Cylinder along y: shape axis z turned about x by 90 degrees.
  std::uint32_t cylinder(double mass, double radius, double length, const Vec& position, double friction = 0.3,
                         double restitution = 0) {
    const double axial = 0.5 * mass * radius * radius, across = mass / 12 * (3 * radius * radius + length * length);
    const auto b = body(BodyMotion::kDynamic, mass, Vec(across, axial, across), position, friction, restitution);
    ShapeRecord& s = shape(b, ShapeType::kCylinder);
    s.radius = radius;
    s.length = length;
    s.orientation[0] = s.orientation[1] = std::sqrt(0.5);
    return b;
  }

  /// Static plane through a point.
  std::uint32_t plane(const Vec& normal, const Vec& point = Vec::Zero(), double friction = 0.3,
                      double restitution = 0) {
    const auto b = body(BodyMotion::kStatic, 0, Vec::Zero(), point, friction, restitution);
    put(shape(b, ShapeType::kPlane).normal, normal.normalized());
    return b;
  }

  JointRecord& joint(JointType type, int parent, std::uint32_t child, const Vec& anchor,
                     const Vec& axis = Vec::UnitY()) {
    JointRecord j{};
    std::snprintf(j.name, sizeof j.name, "joint%zu", manifest.joints.size());
    put(j.anchor, anchor);
    put(j.axis, axis);
    put(j.axis2, axis.unitOrthogonal());
    j.lower = -std::numeric_limits<double>::infinity();
    j.upper = -j.lower;
    j.type = type;
    j.parent = parent;
    j.child = static_cast<int>(child);
    manifest.joints.push_back(j);
    return manifest.joints.back();
  }

  BodyRecord& operator[](std::uint32_t b) { return manifest.bodies[b]; }
};

/// Runs one engine on one world.
class Simulation {
 public:
  Simulation(const std::string& engine, const World& world, double dt) : manifest_(world.manifest), dt_(dt) {
    auto made = make_engine(engine);
    if (!made) throw std::runtime_error(made.error().text());
    engine_ = std::move(*made);
    if (auto loaded = engine_->load(manifest_.view()); !loaded) throw std::runtime_error(loaded.error().text());
    states.resize(manifest_.bodies.size());
    wrenches.assign(states.size(), Wrench{});
    engine_->read(states);
  }

  /// Steps to `until`, calling `each` after every step.
  void to(double until, const std::function<void()>& each = {}) {
    while (time() < until - 0.5 * dt_) {
      step();
      if (each) each();
    }
  }

  void step() {
    engine_->apply(wrenches);
    if (auto fine = engine_->step(time(), dt_); !fine) throw std::runtime_error(fine.error().text());
    ++count_;
    engine_->read(states);
  }

  double time() const { return static_cast<double>(count_) * dt_; }
  Engine& engine() { return *engine_; }
  const BodyState& operator[](std::size_t b) const { return states[b]; }
  Vec position(std::size_t b) const { return vec(states[b].position); }
  Vec velocity(std::size_t b) const { return vec(states[b].velocity); }
  Vec spin(std::size_t b) const { return vec(states[b].angular_velocity); }

  /// World inertia of a dynamic body with principal axes in its frame.
  Eigen::Matrix3d inertia(std::size_t b) const {
    const Eigen::Matrix3d r = quat(states[b]).matrix();
    return r * vec(manifest_.bodies[b].inertia).asDiagonal() * r.transpose();
  }
  /// Kinetic and potential energy of all dynamic bodies, J.
  double energy() const {
    double sum = 0;
    for (std::size_t b = 0; b < states.size(); ++b) {
      const BodyRecord& r = manifest_.bodies[b];
      if (r.motion != BodyMotion::kDynamic) continue;
      sum += 0.5 * r.mass * velocity(b).squaredNorm() + 0.5 * spin(b).dot(inertia(b) * spin(b)) -
             r.mass * vec(manifest_.world.gravity).dot(position(b));
    }
    return sum;
  }

  std::vector<BodyState> states;
  std::vector<Wrench> wrenches;

 private:
  Manifest manifest_;
  double dt_;
  std::uint64_t count_ = 0;
  std::unique_ptr<Engine> engine_;
};

}  // namespace ballast::testing
