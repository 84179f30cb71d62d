// Commands over LCM: hearing them in the coordinator, and sending them (`ballast tell`).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "common/result.h"
#include "launch/obey.h"

namespace ballast::launch {

/// Hears commands on a thread of its own, until it is destroyed.
class CommandListener {
 public:
  static Result<std::unique_ptr<CommandListener>> make(const std::string& url);
  ~CommandListener();
  /// Those that have come since the last call, in order.
  std::vector<RunCommand> take();

 private:
  struct Worker;
  explicit CommandListener(std::unique_ptr<Worker> worker);
  std::unique_ptr<Worker> worker_;
};

/// Sends one command to the runs that listen at this URL (see msgs/url.h). Exit code; nobody answers.
int tell(const RunCommand& command, const std::string& url);

}  // namespace ballast::launch
