// Progress on a terminal or in a log.
#include "launch/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace ballast::launch {

namespace {

/// A piece of the line; the higher its rank, the sooner it gives way.
enum class Rank { kAlways, kError, kRounding, kTime, kSpeed, kStep, kSize };
struct Part {
  Rank rank;
  std::string text;
};

/// A relative figure: per cent, or a power of ten where that would be mostly zeros.
std::string figure(double x) {
  const double size = std::abs(x);
  if (size == 0) return "0";
  if (size >= 9.5e-5) return fmt::format("{:.{}f} %", 100 * x, size < 9.95e-3 ? 2 : size < 9.95e-2 ? 1 : 0);
  std::string text = fmt::format("{:.0e}", x);
  if (const std::size_t zero = text.find("e-0"); zero != std::string::npos) text.erase(zero + 2, 1);
  return text;
}

void add_errors(std::vector<Part>& parts, const LiveErrors& e) {
  constexpr double kNoise = 1e-9;
  const auto add = [&](const char* name, const std::optional<double>& error, const char* sign = "") {
    if (error)
      parts.push_back({std::abs(*error) > kNoise ? Rank::kError : Rank::kRounding, name + (sign + figure(*error))});
  };
  add("density ", e.density_mean);
  add("pressure ", e.pressure);
  add("mass ", e.mass);
  add("energy ", e.energy, e.energy > 0.0 ? "+" : "");  // gained: only that is an error
  add("momentum ", e.momentum);
  add("interface ", e.interface);
}

/// What there is room for, in the order of the parts.
std::string joined(const std::vector<Part>& parts, std::size_t columns) {
  std::vector<std::size_t> order(parts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return parts[i].rank; });
  std::vector<bool> shown(parts.size());
  std::size_t used = 0;
  for (std::size_t i : order) {
    const std::size_t with = used + parts[i].text.size() + (used > 0 ? 2 : 0);
    if (with > columns) break;  // nothing of less use in its place
    shown[i] = true;
    used = with;
  }
  std::string line;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (shown[i]) line += (line.empty() ? "" : "  ") + parts[i].text;
  return line;
}

/// One less than the terminal has: some wrap at the last. In a log, the most.
std::size_t columns_of(bool terminal) {
  winsize size{};
  if (!terminal || ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kProgressColumns;
  return std::min<std::size_t>(kProgressColumns, size.ws_col - 1u);
}

}  // namespace

std::string progress_text(const ProgressState& s, std::size_t columns) {
  const double done = s.duration > 0 ? std::min(1.0, s.time / s.duration) : 1;
  std::vector<Part> parts{{Rank::kAlways, fmt::format("{:3.0f} %", 100 * done)},
                          {Rank::kTime, fmt::format("{:.3f}/{:g} s", s.time, s.duration)}};
  if (s.steps == 0) {
    parts.push_back({Rank::kAlways, fmt::format("preparing, {:.0f} s", s.wall)});
    return joined(parts, columns);
  }
  std::string wall = fmt::format("wall {:.0f} s", s.wall);
  if (done > 0.02 && done < 1 && s.time > s.first)
    wall += fmt::format(", {:.0f} s left", s.wall * (s.duration - s.time) / (s.time - s.first));
  parts.push_back({Rank::kAlways, std::move(wall)});
  add_errors(parts, s.errors);
  if (s.wall > 0) parts.push_back({Rank::kSpeed, fmt::format("{:.3g} x real time", (s.time - s.first) / s.wall)});
  parts.push_back(
      {Rank::kStep, fmt::format("step {:.3g} ms{}", 1e3 * s.dt, s.limit.empty() ? "" : fmt::format(" ({})", s.limit))});
  if (s.particles > 0) parts.push_back({Rank::kSize, fmt::format("{} particles", s.particles)});
  return joined(parts, columns);
}

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {
  next_ = std::chrono::steady_clock::now() + (terminal_ ? std::chrono::milliseconds(250) : std::chrono::seconds(5));
}

Progress::~Progress() { clear(); }

void Progress::show(const ProgressState& state) {
  const auto now = std::chrono::steady_clock::now();
  if (quiet_ || now < next_) return;
  next_ = now + (terminal_ ? std::chrono::milliseconds(250) : std::chrono::seconds(5));
  const std::string text = progress_text(state, columns_of(terminal_));
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", text.c_str());
  std::fflush(stderr);
  shown_ = true;
}

void Progress::clear() {
  if (shown_ && terminal_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

}  // namespace ballast::launch
