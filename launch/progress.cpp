// Progress on a terminal or in a log.
#include "launch/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace ballast::launch {

std::string progress_text(const ProgressState& s) {
  const double done = s.duration > 0 ? std::min(1.0, s.time / s.duration) : 1;
  std::string text = fmt::format("{:3.0f} %  {:.3f}/{:g} s", 100 * done, s.time, s.duration);
  if (s.steps == 0) return text + fmt::format("  preparing, {:.0f} s", s.wall);
  if (s.wall > 0) text += fmt::format("  {:.3g} x real time", (s.time - s.first) / s.wall);
  if (done > 0.02 && done < 1 && s.time > s.first)
    text += fmt::format("  {:.0f} s left", s.wall * (s.duration - s.time) / (s.time - s.first));
  text += fmt::format("  step {:.3g} ms", 1e3 * s.dt);
  if (!s.limit.empty()) text += fmt::format(" ({})", s.limit);
  if (s.particles > 0)
    text += fmt::format("  {} particles  density error {:.2g} %", s.particles, 100 * s.density_error);
  return text;
}

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {
  next_ = std::chrono::steady_clock::now() + (terminal_ ? std::chrono::milliseconds(250) : std::chrono::seconds(5));
}

Progress::~Progress() { clear(); }

void Progress::show(const ProgressState& state) {
  const auto now = std::chrono::steady_clock::now();
  if (quiet_ || now < next_) return;
  next_ = now + (terminal_ ? std::chrono::milliseconds(250) : std::chrono::seconds(5));
  const std::string text = progress_text(state);
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", text.c_str());
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

}  // namespace ballast::launch
