// Receiving: the one place of this folder that talks to LCM.
#pragma once
#include <functional>
#include <string>

#include "common/result.h"

namespace ballast::monitor {

/// Called for each message: channel, bytes.
using Hear = std::function<void(const std::string& channel, const void* data, std::size_t bytes)>;
/// Called at least ten times a second with the seconds since the start; false ends the listening.
using GoOn = std::function<bool(double seconds)>;

/// Subscribes to the channels that match the regular expression at an LCM URL (see msgs/url.h; file:// replays a log)
/// and calls `hear` and `go_on` until the latter says no, the log ends, or SIGINT or SIGTERM comes.
Status listen(const std::string& url, const std::string& channels, const Hear& hear, const GoOn& go_on);

}  // namespace ballast::monitor
