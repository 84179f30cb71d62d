// What commands make of a run: how far it may go. Pure bookkeeping on step numbers; drive asks, the credit follows.
#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace ballast::launch {

/// As command_t.
struct RunCommand {
  std::string action;
  std::int64_t steps = 0;
  std::int64_t run = 0;  ///< process id of the coordinator that is meant; 0: any
  std::string body{};
  std::array<double, 3> force{}, torque{};        ///< N, N m, world, about the centre of mass
  double duration = 0;                            ///< s
  std::array<double, 3> position{};               ///< m, world
  std::array<double, 4> orientation{1, 0, 0, 0};  ///< w x y z
  std::array<double, 3> gravity{};                ///< m/s^2
};

class Obey {
 public:
  static constexpr std::uint64_t kMostRefused = 1000;  ///< that are recorded one by one

  /// A run that is replayed ends after the step after which the first one was stopped.
  /// One that is resumed begins with the commands up to its checkpoint.
  explicit Obey(std::optional<std::uint64_t> stop_after = {}, nlohmann::json record = nlohmann::json::array())
      : stop_after_(stop_after), record_(std::move(record)) {}

  /// Takes a command when `done` steps are done; each is recorded, one that makes no sense with the reason.
  void take(const RunCommand& command, std::uint64_t done, double time);
  /// No step beyond this one may begin; nothing: no such bound.
  std::optional<std::uint64_t> limit() const;
  bool paused() const { return paused_; }
  /// The run is to end now.
  bool stop_due(std::uint64_t done) const { return stop_ || (stop_after_ && done >= *stop_after_); }
  /// [{action, step, time_s, ...}], in order.
  const nlohmann::json& record() const { return record_; }
  /// One that others carry out (act.h): a place in the record, for them to fill.
  std::size_t add(nlohmann::json entry);
  /// A command was refused. True if it is to be recorded: a flood of them must fill neither record nor memory.
  bool keeps_refused() { return ++refused_ <= kMostRefused; }
  /// The run has ended: says how many more were refused.
  void close();
  nlohmann::json& entry(std::size_t place) { return record_[place]; }

 private:
  std::string obey(const RunCommand& command, std::uint64_t done);
  std::optional<std::uint64_t> stop_after_;
  bool paused_ = false, stop_ = false;
  std::uint64_t paused_at_ = 0, refused_ = 0;
  nlohmann::json record_;
};

}  // namespace ballast::launch
