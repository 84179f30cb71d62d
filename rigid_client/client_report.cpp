// Rows and ledger of the rigid process.
#include "rigid_client/client_report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/exchange/hash.h"
#include "common/exchange/sleep_json.h"
#include "common/intervals.h"

namespace ballast::rigid {

namespace {

using Eigen::Map;
using Eigen::Vector3d;
using exchange::BodyMotion;
using exchange::BodyState;
using nlohmann::json;

constexpr double kJitterFrom = 0.5;     // s: what the release of bodies at t = 0 shakes is not jitter
constexpr std::size_t kRowValues = 22;  // per body: as output/columns.h lists them

Map<const Vector3d> vector(const double* p) { return Map<const Vector3d>(p); }
json vector_json(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::uint64_t resident_bytes() {
  unsigned long pages = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%lu %lu", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

double force_mismatch(std::span<const exchange::Wrench> wrenches, std::span<const exchange::Contact> contacts) {
  if (contacts.empty()) return 0;
  std::vector<Vector3d> sum(wrenches.size(), Vector3d::Zero());
  std::vector<bool> touched(wrenches.size(), false);
  for (const auto& c : contacts) {
    sum[c.body] += vector(c.force);
    touched[c.body] = true;
  }
  double worst = 0, scale = 0;
  for (std::size_t b = 0; b < wrenches.size(); ++b) {
    if (!touched[b]) continue;
    scale = std::max(scale, vector(wrenches[b].force).norm());
    worst = std::max(worst, (sum[b] - vector(wrenches[b].force)).norm());
  }
  return scale > 0 ? worst / scale : 0;
}

ClientReport::ClientReport(const exchange::ManifestView& manifest) : manifest_(manifest) {
  const std::size_t n = manifest.bodies.size();
  impulse_.assign(n, Vector3d::Zero());
  gravity(manifest.world->gravity);
  jitter_max_.assign(n, 0);
  jitter_sum_.assign(n, 0);
}

Status ClientReport::begin(exchange::Link& link, std::span<const BodyState> states) {
  last_.states.assign(states.begin(), states.end());
  last_.wrenches.assign(states.size(), exchange::Wrench{});
  energy_start_ = energy(states);
  return row(link, last_);
}

// Rows fall due at the same times as the fluid's: where the step crosses a multiple of the interval.
Status ClientReport::accept(exchange::Link& link, const StepRecord& step) {
  count_momentum(step);
  count_jitter(step);
  contact_sets_ += step.contacts > 0;
  contacts_ += step.contacts;
  force_mismatch_max_ = std::max(force_mismatch_max_, step.force_mismatch);
  ++steps_;
  last_ = step;
  last_row_written_ = false;
  exchange::StepReport report = step.report;
  Map<Vector3d>(report.impulse) = impulse_total_;
  report.impulse_scale = impulse_scale_;
  if (auto sent = link.report(report); !sent) return sent;
  const double every = manifest_.world->output_every;
  const std::int64_t number = every > 0 ? intervals_passed(step.report.time, every) : last_row_ + 1;
  if (number <= last_row_) return ok();
  last_row_ = number;
  return row(link, step);
}

Status ClientReport::last(exchange::Link& link) { return last_row_written_ ? ok() : row(link, last_); }

Status ClientReport::row(exchange::Link& link, const StepRecord& step) {
  values_.clear();
  for (std::size_t b = 0; b < step.states.size(); ++b) {
    if (manifest_.bodies[b].motion == BodyMotion::kStatic) continue;
    const BodyState& s = step.states[b];
    const auto add = [this](const double* p, int n) { values_.insert(values_.end(), p, p + n); };
    add(s.position, 3), add(s.orientation, 4), add(s.velocity, 3), add(s.angular_velocity, 3);
    add(s.acceleration, 3);
    add(step.wrenches[b].force, 3), add(step.wrenches[b].torque, 3);
  }
  last_row_written_ = true;
  return link.frame(exchange::FrameKind::kBodies, step.report.step, step.report.time, values_);
}

void ClientReport::warn(exchange::Link& link, const std::string& text) {
  if (std::find(warnings_.begin(), warnings_.end(), text) != warnings_.end()) return;
  warnings_.push_back(text);
  // A warning that cannot be sent is still in the final report.
  if (auto sent = link.warning(last_.report.step, last_.report.time, text); !sent)
    warnings_.push_back(sent.error().what);
}

Status ClientReport::warn_again(exchange::Link& link) const {
  for (const std::string& text : warnings_)
    if (auto sent = link.warning(last_.report.step, last_.report.time, text); !sent) return sent;
  return ok();
}

// Bodies and axes in the fluid's order, so that both sums agree to the last bit.
void ClientReport::count_momentum(const StepRecord& step) {
  const double dt = step.report.dt;
  for (std::size_t b = 0; b < step.wrenches.size(); ++b) {
    if (manifest_.bodies[b].motion == BodyMotion::kStatic) continue;
    const Vector3d impulse = vector(step.wrenches[b].force) * dt;
    impulse_[b] += impulse;
    impulse_total_ += impulse;
    impulse_scale_ += impulse.norm();
    if (step.asleep) continue;  // a force without a way
    const BodyState &old = last_.states[b], &now = step.states[b];
    work_ +=
        0.5 * impulse.dot(vector(old.velocity) + vector(now.velocity)) +
        0.5 * dt * vector(step.wrenches[b].torque).dot(vector(old.angular_velocity) + vector(now.angular_velocity));
  }
}

void ClientReport::count_jitter(const StepRecord& step) {
  if (step.asleep || step.report.time - step.report.dt < kJitterFrom) return;
  ++jitter_steps_;
  for (std::size_t b = 0; b < step.states.size(); ++b) {
    const double change = (vector(step.states[b].acceleration) - vector(last_.states[b].acceleration)).norm();
    jitter_max_[b] = std::max(jitter_max_[b], change);
    jitter_sum_[b] += change;
  }
}

double ClientReport::energy(std::span<const BodyState> states) const {
  double sum = 0;
  for (std::size_t b = 0; b < states.size(); ++b) {
    const auto& r = manifest_.bodies[b];
    if (r.motion != BodyMotion::kDynamic) continue;
    const BodyState& s = states[b];
    const Eigen::Quaterniond q(s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]);
    const Vector3d w = q.conjugate() * Vector3d(vector(s.angular_velocity));
    const double* i = r.inertia;
    Eigen::Matrix3d inertia;
    inertia << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
    sum += 0.5 * r.mass * vector(s.velocity).squaredNorm() + 0.5 * w.dot(inertia * w) -
           r.mass * vector(gravity_.data()).dot(vector(s.position));
  }
  return sum;
}

std::string ClientReport::json(const std::string& engine, const Timing& timing, const std::string& error,
                               const exchange::Sleep& sleep) const {
  using nlohmann::json;
  json out;
  out["engine"] = engine;
  out["steps"] = steps_;
  out["wall_s"] = timing.wall_s;
  out["rss_bytes"] = resident_bytes();
  out["stages"] = {{"start", timing.start_s},
                   {"engine", timing.engine_s},
                   {"read", timing.read_s},
                   {"report", timing.report_s},
                   {"exchange", timing.waiting_s}};
  json per_body = json::object(), jitter = json::object();
  const double steps = static_cast<double>(std::max<std::uint64_t>(1, jitter_steps_));
  for (std::size_t b = 0; b < impulse_.size(); ++b) {
    if (manifest_.bodies[b].motion == BodyMotion::kStatic) continue;
    per_body[manifest_.bodies[b].name] = vector_json(impulse_[b]);
    jitter[manifest_.bodies[b].name] = {{"max", jitter_max_[b]}, {"mean", jitter_sum_[b] / steps}};
  }
  const double end = energy(last_.states);
  out["ledger"] = {
      {"momentum_received_N_s", vector_json(impulse_total_)},
      {"momentum_received_by_body_N_s", per_body},
      {"momentum_received_scale_N_s", impulse_scale_},
      {"energy_J", {{"bodies_start", energy_start_}, {"bodies_end", end}, {"work_of_fluid_on_bodies", work_}}}};
  out["contact_sets"] = {
      {"received", contact_sets_}, {"contacts", contacts_}, {"force_mismatch_max", force_mismatch_max_}};
  out["jitter_m_s2"] = jitter;
  out["state_hash"] = fmt::format("{:016x}", exchange::state_hash(last_.states));
  out["warnings"] = warnings_;
  if (auto slept = exchange::sleep_json(sleep); !slept.is_null()) out["sleep"] = std::move(slept);
  if (!error.empty()) out["error"] = error;
  return out.dump();
}

}  // namespace ballast::rigid
