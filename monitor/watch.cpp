// Draws the screen on a terminal: five times a second, in the terminal's second page, so that the first comes back.
#include "monitor/watch.h"

#include <fmt/format.h>

#include "monitor/listen.h"
#include "monitor/screen.h"

namespace ballast::monitor {

namespace {

constexpr double kRedraw = 0.2;  // s
constexpr double kGather = 1.2;  // s after the first status with --once: every channel has spoken by then

void print(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print("{}\n", line);
}

void draw(const std::vector<std::string>& lines) {
  std::string text = "\033[H";  // home; each line clears its own rest, so that nothing flickers
  for (const std::string& line : lines) text += line + "\033[K\n";
  text.pop_back();  // a line break in the last line would scroll
  fmt::print("{}\033[J", text);
  std::fflush(stdout);
}

}  // namespace

int watch(const WatchOptions& options) {
  View view;
  double now = 0, heard = 0, first = -1, drawn = -1;
  if (!options.once) fmt::print("\033[?1049h\033[?25l");  // second page, no cursor
  const Status outcome = listen(
      options.url, "BALLAST_.*",
      [&](const std::string& channel, const void* data, std::size_t bytes) {
        view.take(channel, data, bytes);
        heard = now;
      },
      [&](double seconds) {
        now = seconds;
        if (first < 0 && view.has_status()) first = now;
        if (options.once) return first < 0 ? now < options.patience : !view.ended() && now - first < kGather;
        if (now - drawn >= kRedraw) {
          draw(view.lines(now - heard));
          drawn = now;
        }
        return true;
      });
  if (!options.once) fmt::print("\033[?25h\033[?1049l");
  if (!outcome) {
    fmt::print(stderr, "ballast watch: {}\n", outcome.error().text());
    return outcome.error().exit_code;
  }
  print(view.lines(now - heard));
  return view.has_status() ? kFine : kProcessFailed;
}

}  // namespace ballast::monitor
