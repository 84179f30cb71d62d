// From a channel to standard output.
#include "monitor/tap.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "monitor/listen.h"
#include "monitor/rows.h"
#include "msgs/channels.h"

namespace ballast::monitor {

namespace {

/// Prints what it is given, until it has had enough.
class Tap {
 public:
  explicit Tap(const TapOptions& options) : options_(options) {}

  void take(const void* data, std::size_t bytes) {
    auto rows = rows_of(data, bytes);
    ++messages_;
    if (!rows) {
      if (undecodable_++ == 0) fmt::print(stderr, "ballast tap: {}: {}\n", options_.channel, rows.error().text());
      return;
    }
    if (options_.csv && !head_printed_ && !rows->columns.empty()) {
      fmt::print("{}\n", csv_line(rows->columns));
      head_printed_ = true;
    }
    for (const auto& row : rows->rows) {
      if (options_.csv) {
        fmt::print("{}\n", csv_line(row));
      } else {
        for (std::size_t i = 0; i < row.size(); ++i) fmt::print("{}{}={}", i ? " " : "", rows->columns[i], row[i]);
        fmt::print("\n");
      }
    }
    std::fflush(stdout);
  }
  bool enough() const { return std::ferror(stdout) || (options_.messages > 0 && messages_ >= options_.messages); }
  int exit_code() const { return undecodable_ > 0 ? kProcessFailed : messages_ > 0 ? kFine : kProcessFailed; }
  std::uint64_t messages() const { return messages_; }

 private:
  const TapOptions& options_;
  std::uint64_t messages_ = 0, undecodable_ = 0;
  bool head_printed_ = false;
};

}  // namespace

int tap(const TapOptions& options) {
  Tap out(options);
  const Status heard = listen(
      options.url, options.channel, [&](const std::string&, const void* data, std::size_t n) { out.take(data, n); },
      [&](double seconds) { return !out.enough() && (options.seconds <= 0 || seconds < options.seconds); });
  if (!heard) {
    fmt::print(stderr, "ballast tap: {}\n", heard.error().text());
    return heard.error().exit_code;
  }
  if (out.messages() == 0) {
    const bool ours = std::ranges::find(msgs::kAll, options.channel) != std::end(msgs::kAll);
    fmt::print(stderr, "ballast tap: no message came on {}{}\n", options.channel,
               ours ? "" : fmt::format("\n  channels of a run: {}", fmt::join(msgs::kAll, ", ")));
  }
  return out.exit_code();
}

}  // namespace ballast::monitor
