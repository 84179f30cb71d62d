// Free flight, prescribed motion, mobility, and saving of bodies.
#include "rigid_client/body_set.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <numeric>

namespace ballast::rigid {

namespace {

constexpr double kSpeedLimit = 1e6;     // m/s: beyond it a run has diverged
constexpr double kFarthest = 1e9;       // m
constexpr double kAnglePerStage = 0.1;  // rad turned per Runge-Kutta step: local error 1e-9 rad
constexpr int kMostStages = 1000;

Vec3 vec(const double* p) { return {p[0], p[1], p[2]}; }
void put(double* p, const Vec3& v) { p[0] = v.x(), p[1] = v.y(), p[2] = v.z(); }

// Torque-free turning: the angular momentum L is constant in the world, so only the orientation is integrated
// (classical Runge-Kutta of dq/dt = spin * q / 2, spin = I(q)^-1 L); energy errs only through the orientation.
void turn_freely(const Inertia& inertia, const Vec3& momentum, double dt, Quat& q) {
  const auto spin = [&](const Quat& at) -> Vec3 {
    return at.conjugate() * (Vec3)(at * (inertia.body_inverse * (at.conjugate() * momentum)));
  };
  const auto rate = [&](const Eigen::Vector4d& c) -> Eigen::Vector4d {
    const Quat at = Quat(c).normalized();
    const Vec3 w = spin(at);  // body axes: dq/dt = q * w / 2
    return 0.5 * (at * Quat(0, w.x(), w.y(), w.z())).coeffs();
  };
  const double angle = spin(q).norm() * dt;
  const int stages = std::clamp(static_cast<int>(std::ceil(angle / kAnglePerStage)), 1, kMostStages);
  const double h = dt / stages;
  for (int i = 0; i < stages; ++i) {
    const Eigen::Vector4d c = q.coeffs();
    const Eigen::Vector4d k1 = rate(c), k2 = rate(c + 0.5 * h * k1), k3 = rate(c + 0.5 * h * k2), k4 = rate(c + h * k3);
    q = Quat(Eigen::Vector4d(c + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))).normalized();
  }
}

struct Packed {
  double position[3], orientation[4], velocity[3], spin[3];  // orientation: x y z w, Eigen's order
};

struct Head {
  std::uint64_t steps;
  double time, gravity[3];
  std::uint64_t bodies, extra;
};

Status refuse(const exchange::BodyRecord& record, const std::string& what, const std::string& cure) {
  return Error{fmt::format("body '{}': {}", record.name, what), cure, "", kBadInput};
}

Mat3 inertia_matrix(const double* i) {
  Mat3 m;
  m << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
  return m;
}

Status check_record(const exchange::BodyRecord& r, bool planar) {
  const auto finite = [](const double* p, int n) {
    return std::all_of(p, p + n, [](double x) { return std::isfinite(x); });
  };
  if (!finite(r.position, 3) || !finite(r.orientation, 4) || !finite(r.velocity, 3) || !finite(r.angular_velocity, 3)) {
    return refuse(r, "pose or velocity is not a finite number", "give finite numbers for pose and velocities");
  }
  const double norm = std::sqrt(std::inner_product(r.orientation, r.orientation + 4, r.orientation, 0.0));
  if (std::abs(norm - 1) > 1e-6)
    return refuse(r, fmt::format("orientation has length {}", norm), "give a unit quaternion");
  if (r.friction < 0 || r.restitution < 0 || r.restitution > 1 || std::isnan(r.friction) || std::isnan(r.restitution)) {
    return refuse(r, fmt::format("friction {} or restitution {} is out of range", r.friction, r.restitution),
                  "friction must be >= 0, restitution between 0 and 1");
  }
  if (r.motion != exchange::BodyMotion::kDynamic) return ok();
  if (!(r.mass > 0) || !std::isfinite(r.mass)) {
    return refuse(r, fmt::format("mass is {} kg", r.mass), "a dynamic body needs a positive mass or density");
  }
  if (!finite(r.inertia, 6)) return refuse(r, "inertia is not a finite number", "give finite moments of inertia");
  const double smallest =
      planar ? r.inertia[1] : Eigen::SelfAdjointEigenSolver<Mat3>(inertia_matrix(r.inertia)).eigenvalues().minCoeff();
  if (!(smallest > 0)) {
    return refuse(r, fmt::format("smallest moment of inertia is {} kg m^2", smallest),
                  "moments of inertia must be positive");
  }
  return ok();
}

Inertia make_inertia(const exchange::BodyRecord& r, bool planar) {
  Inertia result;
  if (r.motion != exchange::BodyMotion::kDynamic) return result;
  result.mass = r.mass;
  result.inverse_mass = 1 / r.mass;
  if (planar) {
    result.body(1, 1) = r.inertia[1];
    result.body_inverse(1, 1) = 1 / r.inertia[1];
    result.isotropic = true;
    return result;
  }
  result.body = inertia_matrix(r.inertia);
  result.body_inverse = result.body.inverse();
  result.isotropic =
      (result.body - Mat3::Identity() * result.body(0, 0)).cwiseAbs().maxCoeff() < 1e-12 * result.body(0, 0);
  return result;
}

}  // namespace

Quat rotated(const Quat& orientation, const Vec3& angle) {
  const double size = angle.norm();
  const double half = size < 1e-8 ? 0.5 - size * size / 48 : std::sin(0.5 * size) / size;
  const Quat turn(std::cos(0.5 * size), half * angle.x(), half * angle.y(), half * angle.z());
  return (turn * orientation).normalized();
}

Motion prescribed_motion(const exchange::BodyRecord& record, double time) {
  Motion m;
  const double rate = 2 * std::numbers::pi * record.drive_frequency, phase = record.drive_phase;
  const double since =
      std::clamp(time, record.drive_start, std::max(record.drive_start, record.drive_stop)) - record.drive_start;
  const bool moving = time >= record.drive_start && time < record.drive_stop;
  const Vec3 v = vec(record.drive_velocity), w = vec(record.drive_angular_velocity), a = vec(record.drive_amplitude);
  m.position = vec(record.position) + v * since + a * (std::sin(rate * since + phase) - std::sin(phase));
  const double* q = record.orientation;
  m.orientation = rotated(Quat(q[0], q[1], q[2], q[3]), w * since);
  if (moving) {
    m.velocity = v + a * (rate * std::cos(rate * since + phase));
    m.spin = w;
  }
  return m;
}

Vec3 prescribed_acceleration(const exchange::BodyRecord& record, double time) {
  if (time < record.drive_start || time >= record.drive_stop) return Vec3::Zero();
  const double rate = 2 * std::numbers::pi * record.drive_frequency;
  return -rate * rate * std::sin(rate * (time - record.drive_start) + record.drive_phase) * vec(record.drive_amplitude);
}

Status BodySet::load(const exchange::ManifestView& manifest) {
  world = *manifest.world;
  records.assign(manifest.bodies.begin(), manifest.bodies.end());
  const std::size_t n = records.size();
  inertia.resize(n);
  now.assign(n, Motion{});
  wrenches_.assign(n, exchange::Wrench{});
  acceleration_.assign(6 * n, 0);
  reaction_.assign(6 * n, 0);
  extra.clear();
  steps = 0;
  for (std::size_t b = 0; b < n; ++b) {
    const exchange::BodyRecord& r = records[b];
    if (auto fine = check_record(r, planar()); !fine) return fine;
    inertia[b] = make_inertia(r, planar());
    now[b].position = vec(r.position);
    now[b].orientation = Quat(r.orientation[0], r.orientation[1], r.orientation[2], r.orientation[3]).normalized();
    if (!dynamic(b)) continue;
    now[b].velocity = vec(r.velocity);
    now[b].spin = vec(r.angular_velocity);
    confine(b);
  }
  before_ = now;
  drive(0);
  return ok();
}

void BodySet::set_wrenches(std::span<const exchange::Wrench> wrenches) {
  std::copy_n(wrenches.begin(), std::min(wrenches.size(), wrenches_.size()), wrenches_.begin());
}

Vec3 BodySet::force(std::size_t b) const {
  const double* f = wrenches_[b].force;
  return {f[0], planar() ? 0 : f[1], f[2]};
}

Vec3 BodySet::torque(std::size_t b) const {
  const double* t = wrenches_[b].torque;
  return planar() ? Vec3(0, t[1], 0) : vec(t);
}

bool BodySet::has_wrench(std::size_t b) const { return !force(b).isZero(0) || !torque(b).isZero(0); }

Vec3 BodySet::gyroscopic_spin(std::size_t b, double dt) const {
  const Motion& m = now[b];
  if (inertia[b].isotropic) return m.spin;
  const Vec3 momentum = inertia[b].world(m.orientation) * m.spin;
  Quat q = m.orientation;
  turn_freely(inertia[b], momentum, dt, q);
  return inertia[b].world_inverse(q) * momentum;
}

void BodySet::fly(std::size_t b, double dt) {
  Motion& m = now[b];
  const Inertia& i = inertia[b];
  if (has_wrench(b)) {
    m.velocity += dt * (gravity() + i.inverse_mass * force(b));
    m.position += dt * m.velocity;
  } else {
    m.position += dt * (m.velocity + 0.5 * dt * gravity());
    m.velocity += dt * gravity();
  }
  if (i.isotropic) {
    m.spin += dt * (i.world_inverse(m.orientation) * torque(b));
    m.orientation = rotated(m.orientation, dt * m.spin);
  } else {
    const Vec3 momentum = i.world(m.orientation) * m.spin + dt * torque(b);
    turn_freely(i, momentum, dt, m.orientation);
    m.spin = i.world_inverse(m.orientation) * momentum;
  }
  confine(b);
}

void BodySet::drive(double time) {
  time_ = time;
  for (std::size_t b = 0; b < size(); ++b) {
    if (prescribed(b)) now[b] = prescribed_motion(records[b], time);
  }
}

void BodySet::confine(std::size_t b) {
  if (!planar()) return;
  now[b].velocity.y() = 0;
  now[b].spin.x() = 0;
  now[b].spin.z() = 0;
  now[b].position.y() = records[b].position[1];
}

void BodySet::begin_step() {
  before_ = now;
  constrained_.assign(size(), false);
  struck_.assign(6 * size(), 0);
}

void BodySet::strike(std::size_t b, const Vec3& velocity, const Vec3& spin) {
  Eigen::Map<Vec3>(&struck_[6 * b]) += velocity;
  Eigen::Map<Vec3>(&struck_[6 * b + 3]) += spin;
}

/// Acceleration of body b where nothing touches it, without the fluid's wrench: linear, angular.
std::pair<Vec3, Vec3> BodySet::flight_acceleration(std::size_t b, const Motion& motion) const {
  if (inertia[b].isotropic) return {gravity(), Vec3::Zero()};
  const Vec3 momentum = inertia[b].world(motion.orientation) * motion.spin;
  return {gravity(), -(inertia[b].world_inverse(motion.orientation) * motion.spin.cross(momentum))};
}

Status BodySet::check(std::size_t b) const {
  const Motion& m = now[b];
  const bool finite =
      m.position.allFinite() && m.orientation.coeffs().allFinite() && m.velocity.allFinite() && m.spin.allFinite();
  if (finite && m.velocity.norm() <= kSpeedLimit && m.position.norm() <= kFarthest) return ok();
  return Error{fmt::format("body '{}' has diverged: {} m away at {} m/s, spinning with {} rad/s after step {}",
                           records[b].name, m.position.norm(), m.velocity.norm(), m.spin.norm(), steps),
               "use a smaller step (coupling.rigid_step or more coupling.substeps)", "", kDiverged};
}

Status BodySet::end_step(double dt) {
  ++steps;
  for (std::size_t b = 0; b < size(); ++b) {
    put(&acceleration_[6 * b], (now[b].velocity - before_[b].velocity) / dt);
    put(&acceleration_[6 * b + 3], (now[b].spin - before_[b].spin) / dt);
    std::fill_n(&reaction_[6 * b], 6, 0.0);
    if (dynamic(b) && constrained_[b]) {
      const auto [linear, angular] = flight_acceleration(b, before_[b]);
      const auto of = [&](std::size_t at) { return Vec3(vec(&acceleration_[at]) - vec(&struck_[at]) / dt); };
      put(&reaction_[6 * b], of(6 * b) - linear - inertia[b].inverse_mass * force(b));
      put(&reaction_[6 * b + 3],
          of(6 * b + 3) - angular - inertia[b].world_inverse(before_[b].orientation) * torque(b));
    }
    if (auto fine = check(b); !fine) return fine;
  }
  return ok();
}

void BodySet::read(std::span<exchange::BodyState> states) const {
  for (std::size_t b = 0; b < size(); ++b) {
    const Motion& m = now[b];
    exchange::BodyState& s = states[b];
    put(s.position, m.position);
    s.orientation[0] = m.orientation.w();
    put(s.orientation + 1, m.orientation.vec());
    put(s.velocity, m.velocity);
    put(s.angular_velocity, m.spin);
    std::copy_n(&acceleration_[6 * b], 6, s.acceleration);
  }
}

void BodySet::mobility(std::span<exchange::BodyState> states, const std::vector<bool>& held) const {
  for (std::size_t b = 0; b < size(); ++b) {
    exchange::BodyState& s = states[b];
    std::fill_n(s.free_acceleration, 6, 0.0);
    std::fill_n(s.mobility, 36, 0.0);
    if (prescribed(b)) put(s.free_acceleration, prescribed_acceleration(records[b], time_));
    if (!dynamic(b) || held[b]) continue;
    const Mat3 inverse = inertia[b].world_inverse(now[b].orientation);
    const auto [linear, angular] = flight_acceleration(b, now[b]);
    put(s.free_acceleration, linear + vec(&reaction_[6 * b]));
    put(s.free_acceleration + 3, angular + vec(&reaction_[6 * b + 3]));
    for (int i = 0; i < 3; ++i) {
      s.mobility[7 * i] = planar() && i == 1 ? 0 : inertia[b].inverse_mass;
      for (int j = 0; j < 3; ++j) s.mobility[6 * (3 + i) + 3 + j] = inverse(i, j);
    }
  }
}

Status BodySet::obey(const exchange::Command& command) {
  if (command.kind == exchange::CommandKind::kGravity) {
    std::copy_n(command.values, 3, world.gravity);
    return ok();
  }
  Motion& m = now[command.body];
  const double* v = command.values;
  m.position = vec(v);
  m.orientation = Quat(v[3], v[4], v[5], v[6]).normalized();
  confine(command.body);
  before_[command.body] = m;
  return ok();
}

void BodySet::save(std::vector<std::byte>& out) const {
  const std::size_t bodies = size() * (sizeof(Packed) + 12 * sizeof(double));
  out.resize(sizeof(Head) + bodies + extra.size() * sizeof(double));
  std::byte* to = out.data();
  const auto write = [&to](const void* from, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, from, bytes);
    to += bytes;
  };
  const double* g = world.gravity;
  const Head head{steps, time_, {g[0], g[1], g[2]}, size(), extra.size()};
  write(&head, sizeof head);
  for (std::size_t b = 0; b < size(); ++b) {
    Packed p;
    put(p.position, now[b].position);
    std::copy_n(now[b].orientation.coeffs().data(), 4, p.orientation);
    put(p.velocity, now[b].velocity);
    put(p.spin, now[b].spin);
    write(&p, sizeof p);
  }
  write(acceleration_.data(), acceleration_.size() * sizeof(double));
  write(reaction_.data(), reaction_.size() * sizeof(double));
  write(extra.data(), extra.size() * sizeof(double));
}

Status BodySet::restore(std::span<const std::byte> in) {
  Head head{};
  if (in.size() >= sizeof head) std::memcpy(&head, in.data(), sizeof head);
  const std::size_t bodies = size() * (sizeof(Packed) + 12 * sizeof(double));
  if (head.bodies != size() || head.extra != extra.size() ||
      in.size() != sizeof head + bodies + extra.size() * sizeof(double)) {
    return Error{fmt::format("saved state of {} bytes does not belong to these {} bodies", in.size(), size()),
                 "restore into the engine and manifest that saved it", "", kProcessFailed};
  }
  const std::byte* from = in.data() + sizeof head;
  const auto take = [&from](void* to, std::size_t bytes) {
    if (bytes > 0) std::memcpy(to, from, bytes);
    from += bytes;
  };
  steps = head.steps;
  time_ = head.time;
  std::copy_n(head.gravity, 3, world.gravity);
  for (Motion& m : now) {
    Packed p;
    take(&p, sizeof p);
    m.position = vec(p.position);
    std::copy_n(p.orientation, 4, m.orientation.coeffs().data());
    m.velocity = vec(p.velocity);
    m.spin = vec(p.spin);
  }
  take(acceleration_.data(), acceleration_.size() * sizeof(double));
  take(reaction_.data(), reaction_.size() * sizeof(double));
  take(extra.data(), extra.size() * sizeof(double));
  before_ = now;
  return ok();
}

}  // namespace ballast::rigid
