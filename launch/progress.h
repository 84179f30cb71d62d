// The line that says how far a run is.
#pragma once
#include <chrono>
#include <cstdint>
#include <string>

namespace ballast::launch {

/// What the progress line shows.
struct ProgressState {
  double time = 0, duration = 0, dt = 0, wall = 0;  ///< s
  std::string limit;                                ///< what limits dt; empty if nothing is known
  std::uint64_t steps = 0, particles = 0;
  double first = 0;          ///< s, simulated time at the start: not 0 where a run is resumed
  double density_error = 0;  ///< relative, mean over the particles
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

/// The line itself.
std::string progress_text(const ProgressState& state);

}  // namespace ballast::launch
