// `ballast watch`: one screen of text about the run that is sending messages.
#pragma once
#include <string>

namespace ballast::monitor {

struct WatchOptions {
  std::string url;
  bool once = false;     ///< prints one screen and ends
  double patience = 10;  ///< s to wait for the first message with `once`
};

/// Shows until Ctrl-C (or once); returns the exit code.
int watch(const WatchOptions& options);

}  // namespace ballast::monitor
