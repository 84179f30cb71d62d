// Commands to bounds on steps. A pause lowers the credit already given: steps begun go on to their end, no other
// begins.
#include "launch/obey.h"

#include <algorithm>

namespace ballast::launch {

void Obey::take(const RunCommand& command, std::uint64_t done, double time) {
  nlohmann::json entry = {{"action", command.action}, {"step", done}, {"time_s", time}};
  if (command.action == "step") entry["steps"] = command.steps;
  if (const std::string reason = obey(command, done); !reason.empty()) {
    if (!keeps_refused()) return;
    entry["refused"] = reason;
  }
  record_.push_back(std::move(entry));
}

/// Why not, or nothing.
std::string Obey::obey(const RunCommand& command, std::uint64_t done) {
  if (command.action == "pause") {
    if (paused_) return "it is paused already";
    paused_ = true;
    paused_at_ = done;
  } else if (command.action == "step") {
    if (!paused_) return "it is not paused";
    if (command.steps < 1) return "steps must be 1 or more";
    // A step that was under way at the pause counts among them: what matters is where the run stands afterwards.
    paused_at_ = std::max(paused_at_, done) + static_cast<std::uint64_t>(command.steps);
  } else if (command.action == "resume") {
    if (!paused_) return "it is not paused";
    paused_ = false;
  } else if (command.action == "stop") {
    stop_ = true;
  } else {
    return "unknown action";
  }
  return "";
}

std::optional<std::uint64_t> Obey::limit() const {
  if (paused_) return stop_after_ ? std::min(paused_at_, *stop_after_) : paused_at_;
  return stop_after_;
}

void Obey::close() {
  if (refused_ > kMostRefused)
    record_.push_back({{"action", "(more commands)"}, {"refused", "too many"}, {"count", refused_ - kMostRefused}});
}

std::size_t Obey::add(nlohmann::json entry) {
  record_.push_back(std::move(entry));
  return record_.size() - 1;
}

}  // namespace ballast::launch
