// Commands that act: checks, JSON, replay.
#include "launch/act.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <span>

#include "common/scene/nearest.h"
#include "common/scene/reader.h"

namespace ballast::launch {

using exchange::CommandKind;
using nlohmann::json;

namespace {

struct Wanted {
  const RunCommand& command;
  const Scene& scene;
  const std::vector<Body>& bodies;

  std::optional<std::string> body(exchange::Command& out) const {
    std::vector<std::string> names;
    for (const Model& m : scene.models) names.push_back(m.name);
    const auto found = std::ranges::find(names, command.body);
    if (found == names.end())
      return fmt::format("there is no body '{}'; {}", command.body, scene::suggestion(command.body, names));
    out.body = static_cast<std::uint32_t>(found - names.begin());
    if (scene.models[out.body].motion == Motion::kDynamic) return {};
    return fmt::format("'{}' is {}: it moves as the scene says, whatever acts on it", command.body,
                       scene.models[out.body].motion == Motion::kStatic ? "static" : "prescribed");
  }
  bool flat() const { return scene.world.dimension == 2; }
};

std::optional<std::string> unusable(const char* what, std::span<const double> values) {
  for (const double v : values)
    if (!std::isfinite(v)) return fmt::format("{} has {}, which is not a finite number", what, v);
  return {};
}

/// In dimension 2 vectors lie in the plane x-z and axes along y.
std::optional<std::string> off_plane(const char* what, bool flat, std::span<const double> values, bool axis) {
  for (std::size_t k = 0; flat && k < 3; ++k)
    if ((k == 1) != axis && values[k] != 0)
      return fmt::format("{} has {} along {}, but in dimension 2 {}", what, values[k], "xyz"[k],
                         axis ? "bodies turn about y" : "the plane is x-z");
  return {};
}

constexpr double kMostAcceleration = 1e6;  // m/s^2, rad/s^2; as scenes allow

/// A push beyond all sense tears the fluid apart, and its reason is not to be seen in the wreck.
std::optional<std::string> too_strong(const Body& body, const RunCommand& c) {
  const double linear = Vec3::Map(c.force.data()).stableNorm() / body.mass;
  if (linear > kMostAcceleration)
    return fmt::format("the force would accelerate '{}' ({:.4g} kg) by {:.3g} m/s^2, more than {:g}", c.body, body.mass,
                       linear, kMostAcceleration);
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(body.inertia).eigenvalues()[0];
  const double angular = Vec3::Map(c.torque.data()).stableNorm() / least;
  if (least > 0 && angular > kMostAcceleration)
    return fmt::format("the torque would accelerate '{}' by up to {:.3g} rad/s^2, more than {:g}", c.body, angular,
                       kMostAcceleration);
  return {};
}

std::optional<std::string> wrench(const Wanted& w, exchange::Command& out) {
  const RunCommand& c = w.command;
  out.kind = CommandKind::kWrench;
  out.duration = c.duration;
  std::ranges::copy(c.force, out.values);
  std::ranges::copy(c.torque, out.values + 3);
  if (auto why = unusable("the force", c.force)) return why;
  if (auto why = unusable("the torque", c.torque)) return why;
  if (!(c.duration > 0) || !std::isfinite(c.duration))
    return fmt::format("a duration of {} s is not a time greater than 0", c.duration);
  if (auto why = off_plane("the force", w.flat(), c.force, false)) return why;
  if (auto why = off_plane("the torque", w.flat(), c.torque, true)) return why;
  if (c.force == std::array<double, 3>{} && c.torque == std::array<double, 3>{})
    return "it has neither a force nor a torque";
  return too_strong(w.bodies[out.body], c);
}

std::optional<std::string> pose(const Wanted& w, exchange::Command& out) {
  const RunCommand& c = w.command;
  out.kind = CommandKind::kPose;
  if (auto why = unusable("the position", c.position)) return why;
  if (auto why = unusable("the orientation", c.orientation)) return why;
  constexpr double kFar = 1e6;  // m; a run ends as diverged where a body is 1e9 m away
  for (const double x : c.position)
    if (std::abs(x) > kFar) return fmt::format("the position {:g} m is farther away than {:g} m", x, kFar);
  const auto& q = c.orientation;
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(std::abs(length - 1) < 1e-3))
    return fmt::format("the orientation [w, x, y, z] has length {:.4g}, not 1", length);
  if (auto why = off_plane("the position", w.flat(), c.position, false)) return why;
  if (auto why = off_plane("the orientation", w.flat(), std::span(q).subspan(1), true)) return why;
  for (const Joint& joint : w.scene.joints)
    if (joint.parent == c.body || joint.child == c.body)
      return fmt::format("'{}' is held by joint '{}'", c.body, joint.name);
  std::ranges::copy(c.position, out.values);
  for (std::size_t k = 0; k < 4; ++k) out.values[3 + k] = q[k] / length;
  return {};
}

std::optional<std::string> gravity(const Wanted& w, exchange::Command& out) {
  out.kind = CommandKind::kGravity;
  std::ranges::copy(w.command.gravity, out.values);
  if (auto why = unusable("the gravity", w.command.gravity)) return why;
  if (auto why = off_plane("the gravity", w.flat(), w.command.gravity, false)) return why;
  if (const double g = Vec3::Map(w.command.gravity.data()).stableNorm(); g > kMostAcceleration)
    return fmt::format("a gravity of {:.3g} m/s^2 is more than {:g}", g, kMostAcceleration);
  if (w.scene.numerics.reduced_gravity)
    return "the fluid of this scene feels no gravity that could be changed (numerics.reduced_gravity)";
  return {};
}

}  // namespace

bool acts(const RunCommand& command) {
  return command.action == "wrench" || command.action == "pose" || command.action == "gravity";
}

Result<exchange::Command> to_exchange(const RunCommand& command, const Prepared& prepared) {
  exchange::Command out{};
  const Wanted wanted{command, prepared.scene, prepared.bodies};
  std::optional<std::string> why;
  if (command.action != "gravity") why = wanted.body(out);
  if (!why)
    why = command.action == "wrench" ? wrench(wanted, out)
          : command.action == "pose" ? pose(wanted, out)
                                     : gravity(wanted, out);
  if (why) return Error{*why, "", ""};
  return out;
}

json to_json(const RunCommand& c) {
  if (c.action == "wrench")
    return {{"action", c.action},
            {"body", c.body},
            {"force_N", c.force},
            {"torque_N_m", c.torque},
            {"duration_s", c.duration}};
  if (c.action == "pose")
    return {{"action", c.action}, {"body", c.body}, {"position_m", c.position}, {"orientation_wxyz", c.orientation}};
  if (c.action == "gravity") return {{"action", c.action}, {"gravity_m_s2", c.gravity}};
  json out = {{"action", c.action}};
  if (c.action == "step") out["steps"] = c.steps;
  return out;
}

Result<RunCommand> from_json(const json& entry) try {
  RunCommand c;
  c.action = entry.at("action");
  if (c.action != "gravity") c.body = entry.at("body");
  if (c.action == "wrench")
    c.force = entry.at("force_N"), c.torque = entry.at("torque_N_m"), c.duration = entry.at("duration_s");
  if (c.action == "pose") c.position = entry.at("position_m"), c.orientation = entry.at("orientation_wxyz");
  if (c.action == "gravity") c.gravity = entry.at("gravity_m_s2");
  return c;
} catch (const json::exception& e) {
  return Error{fmt::format("cannot read the command {}: {}", entry.dump(), e.what()),
               "take a record that this version of Ballast has written", "--replay"};
}

std::string Act::take(const RunCommand& command, std::uint64_t step, std::uint64_t done, double time) {
  json entry = to_json(command);
  entry["sent_after_step"] = done;
  std::string refused;
  if (auto sent = to_exchange(command, prepared_)) {
    sent->id = place_.size() + 1, sent->step = step;
    if (control_.send(*sent)) {
      place_.push_back(book_.add(std::move(entry)));
      answered_.push_back(false);
      return "";
    }
    refused = "too many commands are waiting";
  } else {
    refused = sent.error().what;
  }
  if (!book_.keeps_refused()) return "";
  entry["refused"] = refused, entry["step"] = done, entry["time_s"] = time;
  book_.add(std::move(entry));
  return fmt::format("after step {} the command {} was refused: {}", done, command.action, refused);
}

std::string Act::result(const exchange::Frame& frame) {
  const exchange::CommandResult result = frame.command();
  if (result.id < 1 || result.id > place_.size() || answered_[result.id - 1]) return "";
  answered_[result.id - 1] = true;
  json& entry = book_.entry(place_[result.id - 1]);
  entry["step"] = frame.head.step, entry["time_s"] = frame.head.time;
  if (result.refused == 0) return "";
  entry["refused"] = frame.reason();
  return fmt::format("after step {} the command {}{} was refused: {}", frame.head.step,
                     entry["action"].get<std::string>(),
                     entry.contains("body") ? " of '" + entry["body"].get<std::string>() + "'" : "", frame.reason());
}

void Act::close(bool failed) {
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (answered_[i]) continue;
    json& entry = book_.entry(place_[i]);
    if (failed)  // its answer comes with a step's report, and that step may be the one that failed
      entry["unanswered"] = "the run failed before it said whether this took effect";
    else
      entry["refused"] = "the run ended before it took effect";
  }
}

std::string motion_hash(Scene scene) {
  Output output;
  output.every = scene.output.every;  // steps end there
  scene.output = output;
  scene.probes.clear(), scene.expects.clear();
  return fmt::format("{:016x}", scene_hash(scene));
}

Status same_motion(const Replay& replay, const Scene& scene) {
  if (replay.motion_hash.empty() || replay.motion_hash == motion_hash(scene)) return ok();
  return Error{
      "the record is not of this scene",
      "give the scene and the options of the first run: from another start the same commands do something else",
      "--replay"};
}

Result<Replay> read_replay(const std::string& record_file) {
  std::ifstream file(record_file);
  if (!file) return Error{"cannot read the record " + record_file, "check the path", "--replay"};
  const json record = json::parse(file, nullptr, false);
  Replay replay;
  if (record.is_object() && record.contains("motion_hash") && record["motion_hash"].is_string())
    replay.motion_hash = record["motion_hash"];
  const auto damaged = [&](const char* key) {
    return Error{fmt::format("{} has '{}' in a form that no record has", record_file, key), "take another record",
                 "--replay"};
  };
  if (record.is_object() && record.contains("stopped_after_step")) {
    if (!record["stopped_after_step"].is_number_unsigned()) return damaged("stopped_after_step");
    replay.stop_after = record["stopped_after_step"];
  }
  const json commands = record.is_object() && record.contains("commands") ? record["commands"] : json::array();
  if (!commands.is_array()) return damaged("commands");
  for (const json& entry : commands) {
    if (!entry.is_object() || !entry.contains("action") || !entry["action"].is_string()) return damaged("commands");
    RunCommand named;
    named.action = entry["action"];
    // Without a step: the run ended before it took effect.
    if (!acts(named) || entry.contains("refused") || !entry.contains("step")) continue;
    auto command = from_json(entry);
    if (!command) return command.error();
    if (!entry["step"].is_number_unsigned()) return damaged("commands");
    replay.commands.push_back({entry["step"], *command});
  }
  if (!replay.stop_after && replay.commands.empty())
    return Error{fmt::format("{} is no record of a run that a command stopped or acted on", record_file),
                 "other runs need no --replay: the same scene gives the same result", "--replay"};
  return replay;
}

}  // namespace ballast::launch
