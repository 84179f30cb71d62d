// Live messages for monitors over LCM, from a thread of their own that nobody waits for.
#pragma once
#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "common/exchange/link.h"
#include "common/result.h"
#include "launch/live_errors.h"
#include "launch/prepare.h"

namespace ballast::launch {

/// How a run stands, as the coordinator knows it; becomes status_t.
struct RunStatus {
  int run = 0;                  ///< process id of the coordinator
  std::string state;            ///< starting, running, paused, finished, failed
  exchange::StepReport last{};  ///< of the fluid, or of the rigid process alone
  LiveErrors errors;
  std::uint64_t steps = 0;
  double wall = 0;        ///< s since the start
  double first_time = 0;  ///< s, simulated at the start: not 0 where a run is resumed
  struct Process {
    int pid = 0;
    std::string state = "none";    ///< none, absent, running, finished, dead
    double compute = 0, wait = 0;  ///< s so far
  };
  Process fluid, rigid;
  std::size_t warnings = 0;
  bool obeys = false;  ///< commands over LCM
  int exit_code = 0;
};

class Publisher {
 public:
  /// Whether this build has LCM at all; the error says what to install.
  static Status available();
  /// Frames that a process should write for the messages of this run: bits of Header::monitor.
  static std::uint32_t frames_wanted(const Prepared& prepared);
  using Clock = std::chrono::steady_clock;
  /// Opens the URL (see msgs/url.h) and starts the thread. `prepared` must outlive this object. `now` says when a
  /// status is due.
  static Result<std::unique_ptr<Publisher>> make(const Prepared& prepared, const std::string& url,
                                                 std::function<Clock::time_point()> now = Clock::now);
  ~Publisher();

  /// Takes over a frame that has been collected. Steps, probes, checkpoints and answers to commands make no message; a
  /// full queue drops, and counts.
  void take(exchange::Role role, exchange::Frame&& frame);
  /// Ten times a second.
  bool status_due() const { return now_() >= next_status_; }
  void status(const RunStatus& status);
  /// Sends the last status and what is in the queue, within half a second; what is left then is dropped. For the
  /// record: url, messages sent, dropped, failed.
  nlohmann::json close(const RunStatus& last);

 private:
  struct Worker;
  Publisher(std::shared_ptr<Worker> worker, std::function<Clock::time_point()> now);
  std::shared_ptr<Worker> worker_;  // shared with the thread, which may outlive this object if a monitor blocks it
  std::function<Clock::time_point()> now_;
  Clock::time_point next_status_ = Clock::time_point::min();
  bool closed_ = false;
};

}  // namespace ballast::launch
