// Speeds compared with a bound, and the next time at which something happens.
#include "common/exchange/sleep.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/adding_watch.h"
#include "common/intervals.h"

namespace ballast::exchange {

namespace {

using Eigen::Map;
using Eigen::Vector3d;

double norm(const double* v) { return Map<const Vector3d>(v).norm(); }

/// Of the shape's furthest point from its body's origin, m; planes belong to bodies that cannot turn.
double reach_of(const ShapeRecord& shape, const ManifestView& manifest) {
  double own = 0;
  switch (shape.type) {
    case ShapeType::kBox:
      own = 0.5 * norm(shape.size);
      break;
    case ShapeType::kSphere:
      own = shape.radius;
      break;
    case ShapeType::kCylinder:
      own = std::hypot(shape.radius, 0.5 * shape.length);
      break;
    case ShapeType::kCapsule:
      own = shape.radius + 0.5 * shape.length;
      break;
    case ShapeType::kPlane:
      break;
    case ShapeType::kMesh:
      for (std::uint32_t v = shape.first_vertex; v < shape.first_vertex + shape.vertex_count; ++v)
        own = std::max(own, norm(&manifest.vertices[3 * v]));
      break;
  }
  return norm(shape.position) + own;
}

}  // namespace

Sleep::Sleep(const ManifestView& manifest)
    : speed_(manifest.world->sleep_speed),
      after_(manifest.world->sleep_after),
      output_every_(manifest.world->output_every) {
  if (!(speed_ > 0)) return;
  reach_.assign(manifest.bodies.size(), 0.0);
  for (const ShapeRecord& shape : manifest.shapes)
    reach_[shape.body] = std::max(reach_[shape.body], reach_of(shape, manifest));
  for (const BodyRecord& body : manifest.bodies) {
    if (body.motion != BodyMotion::kPrescribed) continue;
    const bool moves = norm(body.drive_velocity) > 0 || norm(body.drive_angular_velocity) > 0 ||
                       (norm(body.drive_amplitude) > 0 && body.drive_frequency > 0);
    if (moves && body.drive_stop > body.drive_start) drives_.push_back({body.drive_start, body.drive_stop});
  }
  for (const JointRecord& joint : manifest.joints)
    if (joint.motor_max_effort > 0 && joint.motor_velocity != 0)
      awake_because_ = std::string("the motor of joint '") + joint.name + "' keeps the scene awake";
}

double Sleep::until(double time) const {
  const AddingWatch watch(watched_);
  // The negation: a speed that is not a number is not slow.
  if (!possible() || !(fastest_ < speed_) || time < pushed_until_ || time - quiet_since_ < after_) return time;
  double end = std::numeric_limits<double>::infinity();
  if (output_every_ > 0) end = static_cast<double>(intervals_passed(time, output_every_) + 1) * output_every_;
  for (const Drive& drive : drives_) {
    if (time < drive.start) {
      end = std::min(end, drive.start);
    } else if (time < drive.stop) {
      return time;
    }
  }
  return end;
}

void Sleep::computed(double time, std::span<const BodyState> states, double others) {
  const AddingWatch watch(watched_);
  if (!possible()) return;
  asleep_ = false;
  fastest_ = others;
  for (std::size_t b = 0; b < states.size(); ++b)
    fastest_ = std::max(fastest_, norm(states[b].velocity) + reach_[b] * norm(states[b].angular_velocity));
  if (!(fastest_ < speed_)) quiet_since_ = time;
}

void Sleep::slept(double begin, double time) {
  if (!asleep_) naps_.push_back({begin, begin, fastest_});
  asleep_ = true;
  naps_.back().to = time;
  ++steps_;
}

void Sleep::command(const Command& command, double time) {
  quiet_since_ = time;
  if (command.kind == CommandKind::kWrench) pushed_until_ = std::max(pushed_until_, time + command.duration);
}

void Sleep::took(double wall, double dt) {
  (asleep_ ? slept_wall_ : computed_wall_) += wall;
  (asleep_ ? slept_time_ : computed_time_) += dt;
}

double Sleep::saved() const {
  return computed_time_ > 0 ? slept_time_ * computed_wall_ / computed_time_ - slept_wall_ : 0;
}

double Sleep::seconds() const {
  double sum = 0;
  for (const Nap& nap : naps_) sum += nap.to - nap.from;
  return sum;
}

double Sleep::drift() const {
  double sum = 0;
  for (const Nap& nap : naps_) sum += (nap.to - nap.from) * nap.speed;
  return sum;
}

}  // namespace ballast::exchange
