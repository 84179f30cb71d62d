// ODE joints. A spring with a damper is a motor row: target -k x/(k h + c), softness 1/(k h + c), which is the implicit
// step of k x + c v (ODE manual, "How to use ERP and CFM"); as a row of its own it leaves limits and motor free.
#include "rigid_client/ode_joints.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ballast::rigid {

namespace {

using exchange::JointRecord;
using exchange::JointType;

constexpr double kJointErp = 0.2;  // share of a joint's gap closed per step; doubled by the midpoint step
constexpr double kStopErp =
    0.2;  // the same beyond a limit, there bounded by return_speed_ so that a stop does not throw
constexpr double kReturnShare = 0.05;  // of sqrt(g/L) (1/s): return speed from beyond a limit

const char* type_name(JointType type) {
  switch (type) {
    case JointType::kFixed:
      return "fixed";
    case JointType::kRevolute:
      return "revolute";
    case JointType::kPrismatic:
      return "prismatic";
    case JointType::kBall:
      return "ball";
    case JointType::kUniversal:
      return "universal";
  }
  return "unknown";
}

bool has_axis_value(JointType type) { return type == JointType::kRevolute || type == JointType::kPrismatic; }
bool has_limit(const JointRecord& r) { return std::isfinite(r.lower) || std::isfinite(r.upper); }
bool has_spring(const JointRecord& r) { return r.spring != 0 || r.damper != 0; }

Status refuse(const JointRecord& r, const std::string& what, const std::string& cure) {
  return Error{fmt::format("joint '{}': {}", r.name, what), cure, "", kBadInput};
}

}  // namespace

Status OdeJoints::check(const JointRecord& r, const BodySet& bodies) const {
  const int n = static_cast<int>(bodies.size());
  if (r.child < 0 || r.child >= n || r.parent < -1 || r.parent >= n || r.parent == r.child) {
    return refuse(r, fmt::format("joins body {} to body {}", r.parent, r.child),
                  "name two different bodies of the scene");
  }
  if (bodies.records[static_cast<std::size_t>(r.child)].motion == exchange::BodyMotion::kStatic) {
    return refuse(r, "its child is static", "make the moving body the child and the static one the parent");
  }
  if (!has_axis_value(r.type) && (has_limit(r) || has_spring(r) || r.motor_max_effort > 0)) {
    return refuse(r, fmt::format("engine ode has no limit, motor, spring or damper on a {} joint", type_name(r.type)),
                  "use a revolute or prismatic joint");
  }
  if (r.spring < 0 || r.damper < 0 || r.motor_max_effort < 0) {
    return refuse(r, "spring, damper and motor effort must not be negative", "give values >= 0");
  }
  const bool turns = r.type == JointType::kRevolute;
  const auto too_far = [](double limit) { return std::isfinite(limit) && std::abs(limit) > std::numbers::pi; };
  if (turns && (too_far(r.lower) || too_far(r.upper))) {
    return refuse(r, fmt::format("engine ode has no limits beyond half a turn ({} .. {} rad)", r.lower, r.upper),
                  "keep both limits within -180..180 deg");
  }
  if (has_limit(r) && r.lower > r.upper) return refuse(r, "its lower limit is above its upper limit", "swap them");
  if (!bodies.planar()) return ok();
  const double y = std::abs(r.axis[1]);
  if ((turns && y < 1 - 1e-9) || (r.type == JointType::kPrismatic && y > 1e-9) || r.type == JointType::kUniversal) {
    return refuse(r, fmt::format("a {} joint with this axis leaves the plane x-z", type_name(r.type)),
                  "in dimension 2 hinges turn about y and sliders move in x-z");
  }
  return ok();
}

Status OdeJoints::load(const exchange::ManifestView& manifest, BodySet& bodies, dWorldID world,
                       const std::vector<dBodyID>& ode) {
  world_ = world;
  entries_.clear();
  const double g = bodies.gravity().norm(), length = bodies.world.length_scale;
  return_speed_ = g > 0 ? kReturnShare * std::sqrt(g / length) : 1 / bodies.world.duration;
  for (const JointRecord& record : manifest.joints) {
    if (auto fine = check(record, bodies); !fine) return fine;
    Entry entry;
    entry.record = record;
    const bool to_body = record.parent >= 0 && ode[static_cast<std::size_t>(record.parent)] != nullptr;
    entry.parent = to_body ? record.parent : -1;
    const dBodyID parent = to_body ? ode[static_cast<std::size_t>(record.parent)] : nullptr;
    make(entry, world, ode[static_cast<std::size_t>(record.child)], parent);
    entries_.push_back(entry);
  }
  bodies.extra.assign(entries_.size(), 0);
  return ok();
}

void OdeJoints::make(Entry& entry, dWorldID world, dBodyID child, dBodyID parent) {
  const JointRecord& r = entry.record;
  const double *p = r.anchor, *a = r.axis, *b = r.axis2;
  switch (r.type) {
    case JointType::kFixed:
      entry.joint = dJointCreateFixed(world, nullptr);
      dJointAttach(entry.joint, child, parent);
      dJointSetFixed(entry.joint);
      break;
    case JointType::kRevolute:
      entry.joint = dJointCreateHinge(world, nullptr);
      dJointAttach(entry.joint, child, parent);
      dJointSetHingeAnchor(entry.joint, p[0], p[1], p[2]);
      dJointSetHingeAxis(entry.joint, a[0], a[1], a[2]);
      break;
    case JointType::kPrismatic:
      entry.joint = dJointCreateSlider(world, nullptr);
      dJointAttach(entry.joint, child, parent);
      dJointSetSliderAxis(entry.joint, a[0], a[1], a[2]);
      break;
    case JointType::kBall:
      entry.joint = dJointCreateBall(world, nullptr);
      dJointAttach(entry.joint, child, parent);
      dJointSetBallAnchor(entry.joint, p[0], p[1], p[2]);
      break;
    case JointType::kUniversal:
      entry.joint = dJointCreateUniversal(world, nullptr);
      dJointAttach(entry.joint, child, parent);
      dJointSetUniversalAnchor(entry.joint, p[0], p[1], p[2]);
      dJointSetUniversalAxis1(entry.joint, b[0], b[1], b[2]);  // fixed in ODE's first body, our child
      dJointSetUniversalAxis2(entry.joint, a[0], a[1], a[2]);  // fixed in the parent
      break;
  }
  if (has_spring(r)) make_spring(entry, world, child, parent);
}

void OdeJoints::make_spring(Entry& entry, dWorldID world, dBodyID child, dBodyID parent) {
  const double* a = entry.record.axis;
  if (entry.record.type == JointType::kRevolute) {
    entry.spring = dJointCreateAMotor(world, nullptr);
    dJointAttach(entry.spring, child, parent);
    dJointSetAMotorMode(entry.spring, dAMotorUser);
    dJointSetAMotorNumAxes(entry.spring, 1);
    dJointSetAMotorAxis(entry.spring, 0, 1, a[0], a[1], a[2]);
  } else {
    entry.spring = dJointCreateLMotor(world, nullptr);
    dJointAttach(entry.spring, child, parent);
    dJointSetLMotorNumAxes(entry.spring, 1);
    dJointSetLMotorAxis(entry.spring, 0, 1, a[0], a[1], a[2]);
  }
}

void OdeJoints::measure(BodySet& bodies) {
  for (std::size_t j = 0; j < entries_.size(); ++j) {
    Entry& e = entries_[j];
    if (e.record.type == JointType::kRevolute) {
      const double turn = 2 * std::numbers::pi;
      const double angle = dJointGetHingeAngle(e.joint);
      bodies.extra[j] = angle + turn * std::round((bodies.extra[j] - angle) / turn);
      e.rate = dJointGetHingeAngleRate(e.joint);
    } else if (e.record.type == JointType::kPrismatic) {
      bodies.extra[j] = dJointGetSliderPosition(e.joint);
      e.rate = dJointGetSliderPositionRate(e.joint);
    }
    e.value = bodies.extra[j];
  }
}

bool OdeJoints::smooth(std::size_t j, double h) const {
  const Entry& e = entries_[j];
  if (e.record.motor_max_effort > 0) return false;
  const double reach = 1.5 * h * std::abs(e.rate);  // 1.5: the rate grows within the step
  return e.value - reach > e.record.lower && e.value + reach < e.record.upper;
}

void OdeJoints::set(const Entry& entry, int parameter, double value) {
  if (entry.record.type == JointType::kRevolute) dJointSetHingeParam(entry.joint, parameter, value);
  if (entry.record.type == JointType::kPrismatic) dJointSetSliderParam(entry.joint, parameter, value);
  if (entry.record.type == JointType::kBall) dJointSetBallParam(entry.joint, parameter, value);
  if (entry.record.type == JointType::kFixed) dJointSetFixedParam(entry.joint, parameter, value);
}

// A kick stands at the start of the step, -k (x + h/4 (v' - v)) - c v': with the drift x += h v' behind it that is a
// swing that neither grows nor fades at any w h (symplectic Euler with k / (1 + (w h)^2 / 4)).
void OdeJoints::prepare_spring(const Entry& entry, Solve solve, double h) {
  const JointRecord& r = entry.record;
  const bool kick = solve == Solve::kKick;
  const double ahead = kick ? 0.25 * h : h;
  const double stiffness = r.spring * ahead + r.damper;
  const double from = entry.value - r.rest - (kick ? ahead * entry.rate : 0);
  const bool silent = solve == Solve::kImpulse || (solve == Solve::kSmooth && entry.kicks);
  const auto put = r.type == JointType::kRevolute ? dJointSetAMotorParam : dJointSetLMotorParam;
  put(entry.spring, dParamVel, -r.spring * from / stiffness);
  put(entry.spring, dParamCFM, 1 / stiffness);
  put(entry.spring, dParamFMax, silent ? 0 : dInfinity);
}

void OdeJoints::prepare(Solve solve, double h, double softness) {
  const bool no_time = solve == Solve::kImpulse || solve == Solve::kKick;
  const double erp = no_time ? 0 : kJointErp;
  dWorldSetERP(world_, erp);
  dWorldSetCFM(world_, softness);
  for (const Entry& e : entries_) {
    if (!has_axis_value(e.record.type)) {
      set(e, dParamERP, erp);
      set(e, dParamCFM, softness);
      continue;
    }
    const bool limits = solve != Solve::kSmooth;
    const double beyond = std::max({e.record.lower - e.value, e.value - e.record.upper, 0.0});
    const double stop = no_time ? 0 : beyond > 0 ? std::min(kStopErp, return_speed_ * h / beyond) : kStopErp;
    set(e, dParamLoStop, limits && std::isfinite(e.record.lower) ? e.record.lower : -dInfinity);
    set(e, dParamHiStop, limits && std::isfinite(e.record.upper) ? e.record.upper : dInfinity);
    set(e, dParamStopERP, stop);
    set(e, dParamStopCFM, softness);
    set(e, dParamVel, e.record.motor_velocity);
    set(e, dParamFMax, solve == Solve::kPlain ? e.record.motor_max_effort : 0);
    if (e.spring != nullptr) prepare_spring(e, solve, h);
  }
}

}  // namespace ballast::rigid
