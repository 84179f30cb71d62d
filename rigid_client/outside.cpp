// Wrenches, poses and gravity from outside.
#include "rigid_client/outside.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>

namespace ballast::rigid {

using exchange::Command;
using exchange::CommandKind;

namespace {

/// On a step that begins at `time`, and on the first one in any case; sums of steps round.
bool acts(const Outside::Push& push, double time) { return time <= push.from || time < push.until * (1 - 1e-12); }

}  // namespace

std::string Outside::take(const Command& command, double time, std::span<const exchange::BodyState> states,
                          Engine& engine) {
  if (command.kind != CommandKind::kGravity && manifest_.bodies[command.body].motion != exchange::BodyMotion::kDynamic)
    return fmt::format("'{}' does not move freely", manifest_.bodies[command.body].name);
  if (command.kind == CommandKind::kPose) return place(command, states, engine);
  if (command.kind == CommandKind::kGravity) {
    const Status obeyed = engine.obey(command);
    return obeyed ? "" : obeyed.error().what;
  }
  if (!(command.duration > 0)) return fmt::format("a wrench of {} s does nothing", command.duration);
  Push& push = pushes_.emplace_back();
  push.body = command.body, push.from = time, push.until = time + command.duration;
  std::copy_n(command.values, 6, push.wrench);
  return "";
}

std::string Outside::place(const Command& command, std::span<const exchange::BodyState> states, Engine& engine) {
  if (!overlap_) {
    auto made = Overlap::make(manifest_);
    if (!made) return made.error().what;
    overlap_ = std::move(*made);
  }
  std::vector<exchange::BodyState> then(states.begin(), states.end());
  std::copy_n(command.values, 3, then[command.body].position);
  std::copy_n(command.values + 3, 4, then[command.body].orientation);
  if (const auto found = overlap_->deepest(command.body, then))
    return fmt::format("it would overlap '{}' by {:.3g} m", manifest_.bodies[found->other].name, found->depth);
  const Status obeyed = engine.obey(command);
  return obeyed ? "" : obeyed.error().what;
}

void Outside::add_to(std::span<exchange::Wrench> wrenches, double time) {
  std::erase_if(pushes_, [&](const Push& push) { return !acts(push, time); });
  for (const Push& push : pushes_) {
    for (int k = 0; k < 3; ++k) wrenches[push.body].force[k] += push.wrench[k];
    for (int k = 0; k < 3; ++k) wrenches[push.body].torque[k] += push.wrench[3 + k];
  }
}

void Outside::add_to(std::span<exchange::BodyState> states, double time) const {
  using Matrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  for (const Push& push : pushes_) {
    if (!acts(push, time)) continue;
    exchange::BodyState& state = states[push.body];
    Eigen::Map<Eigen::Matrix<double, 6, 1>>(state.free_acceleration) +=
        Eigen::Map<const Matrix>(state.mobility) * Eigen::Map<const Eigen::Matrix<double, 6, 1>>(push.wrench);
  }
}

}  // namespace ballast::rigid
