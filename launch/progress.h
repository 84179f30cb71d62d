// The line that says how far a run is, how long it takes, and how wrong it is by now.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>

#include "launch/live_errors.h"

namespace ballast::launch {

/// What the progress line shows.
struct ProgressState {
  double time = 0, duration = 0, dt = 0, wall = 0;  ///< s
  std::string limit;                                ///< what limits dt; empty if nothing is known
  std::uint64_t steps = 0, particles = 0;
  double first = 0;  ///< s, simulated time at the start: not 0 where a run is resumed
  LiveErrors errors;
};

/// One line rewritten four times a second on a terminal, a plain line every 5 s elsewhere; on stderr.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  void show(const ProgressState& state);
  /// Takes the line away, so that other text may be printed.
  void clear();

 private:
  bool quiet_, terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

inline constexpr std::size_t kProgressColumns = 100;  ///< at most, however wide the terminal is

/// The line itself. Where there is no room for all of it, what says least gives way: the number of particles, the step,
/// the speed, the simulated time, then errors at rounding level.
std::string progress_text(const ProgressState& state, std::size_t columns = kProgressColumns);

}  // namespace ballast::launch
