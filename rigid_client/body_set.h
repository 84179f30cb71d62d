// Everything about the bodies that is the same in every engine: state, wrenches, free flight, prescribed motion,
// mobility. An engine built on it keeps no state of its own between steps, which is what makes restore and replay
// exact.
#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/exchange/manifest.h"
#include "common/result.h"

namespace ballast::rigid {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Quat = Eigen::Quaterniond;

/// State of one body: world frame, about the origin of its body frame (dynamic: the centre of mass).
struct Motion {
  Vec3 position = Vec3::Zero();         ///< m
  Quat orientation = Quat::Identity();  ///< unit
  Vec3 velocity = Vec3::Zero();         ///< m/s
  Vec3 spin = Vec3::Zero();             ///< rad/s
};

/// Velocity of the material point of a body that is at `point` (world).
inline Vec3 velocity_at(const Motion& motion, const Vec3& point) {
  return motion.velocity + motion.spin.cross(point - motion.position);
}

/// Rotation by the vector `angle` (rad, world frame) after `orientation`.
Quat rotated(const Quat& orientation, const Vec3& angle);

/// Mass properties of a dynamic body. In dimension 2 only the yy entries of the inverse are non-zero.
struct Inertia {
  double mass = 0, inverse_mass = 0;  ///< kg, 1/kg; 0 unless dynamic
  Mat3 body = Mat3::Zero();           ///< kg m^2, body axes
  Mat3 body_inverse = Mat3::Zero();
  bool isotropic = false;  ///< a multiple of the identity: the spin is constant in free flight
  Mat3 world(const Quat& q) const { return q.matrix() * body * q.matrix().transpose(); }
  Mat3 world_inverse(const Quat& q) const { return q.matrix() * body_inverse * q.matrix().transpose(); }
};

/// Pose and twist of a prescribed body at a time (see scene.h, Prescription).
Motion prescribed_motion(const exchange::BodyRecord& record, double time);
Vec3 prescribed_acceleration(const exchange::BodyRecord& record, double time);

class BodySet {
 public:
  /// Copies the records; refuses masses, inertias, poses and velocities that cannot be integrated (name of the body,
  /// value).
  Status load(const exchange::ManifestView& manifest);

  std::size_t size() const { return records.size(); }
  bool planar() const { return world.dimension == 2; }
  bool dynamic(std::size_t b) const { return records[b].motion == exchange::BodyMotion::kDynamic; }
  bool prescribed(std::size_t b) const { return records[b].motion == exchange::BodyMotion::kPrescribed; }
  Vec3 gravity() const { return Vec3(world.gravity[0], planar() ? 0 : world.gravity[1], world.gravity[2]); }

  void set_wrenches(std::span<const exchange::Wrench> wrenches);
  /// Force and torque of the fluid on body b; components that leave the plane are dropped in dimension 2.
  Vec3 force(std::size_t b) const;
  Vec3 torque(std::size_t b) const;
  bool has_wrench(std::size_t b) const;

  /// Moves a body that touches nothing. Without wrench the parabola is exact; with one the step is kick, then drift:
  /// a wrench that depends on the position (buoyancy) would be pumped by the exact formula (COUPLING.md, 4).
  void fly(std::size_t b, double dt);
  /// Spin after dt without torque: what gyroscopic terms do to it.
  Vec3 gyroscopic_spin(std::size_t b, double dt) const;
  /// Places all prescribed bodies where they are at `time`.
  void drive(double time);
  /// Keeps motion in the plane x-z in dimension 2.
  void confine(std::size_t b);

  void begin_step();
  /// Says that a contact or a joint acts on body b in this step, and how much of its change of twist is an impact's.
  void constrain(std::size_t b) { constrained_[b] = true; }
  void strike(std::size_t b, const Vec3& velocity, const Vec3& spin);
  Status end_step(double dt);  ///< accelerations; a body that is not finite or faster than 1e6 m/s is an error, code 4

  void read(std::span<exchange::BodyState> states) const;
  void mobility(std::span<exchange::BodyState> states, const std::vector<bool>& held) const;
  /// A pose, its velocity kept, or a gravity from outside.
  Status obey(const exchange::Command& command);
  void save(std::vector<std::byte>& out) const;
  Status restore(std::span<const std::byte> in);

  exchange::WorldRecord world{};
  std::vector<exchange::BodyRecord> records;
  std::vector<Inertia> inertia;
  std::vector<Motion> now;
  std::vector<double> extra;  ///< state that an engine adds (joint angles), saved and restored with the rest
  std::uint64_t steps = 0;    ///< taken since load

 private:
  Status check(std::size_t b) const;
  std::pair<Vec3, Vec3> flight_acceleration(std::size_t b, const Motion& motion) const;
  double time_ = 0;  ///< s, of the prescribed poses
  std::vector<exchange::Wrench> wrenches_;
  std::vector<Motion> before_;
  std::vector<bool> constrained_;
  std::vector<double> acceleration_;  ///< 6 per body
  std::vector<double> struck_;        ///< change of twist by impacts in this step, 6 per body
  std::vector<double> reaction_;  ///< of contacts and joints in the last step, per mass, without impacts, 6 per body
};

}  // namespace ballast::rigid
