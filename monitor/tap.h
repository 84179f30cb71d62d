// `ballast tap CHANNEL`: the messages of one channel as text.
#pragma once
#include <cstdint>
#include <string>

namespace ballast::monitor {

struct TapOptions {
  std::string channel, url;
  bool csv = false;            ///< CSV with a head line; else name=value lines
  std::uint64_t messages = 0;  ///< ends after so many; 0: never
  double seconds = 0;          ///< ends after so long; 0: never
};

/// Prints until the end of a log, Ctrl-C or the bounds above; returns the exit code.
int tap(const TapOptions& options);

}  // namespace ballast::monitor
