// Starting, watching and ending the fluid and the rigid process.
#pragma once
#include <sys/types.h>

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/exchange/link.h"
#include "common/result.h"

namespace ballast::launch {

/// What to start for one role.
struct Command {
  std::string program;  ///< absolute path
  std::vector<std::string> arguments;
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to ours
  std::string log;                                               ///< file for standard output and error; empty: ours
  std::string line() const;                                      ///< to type in a terminal
};

/// Folder of the running executable, where the other programs lie too.
std::string program_folder();

/// Child processes that cannot outlive this object, nor this process (exchange/process.h: end_with_coordinator).
class Children {
 public:
  Children() = default;
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;
  ~Children();

  Status start(exchange::Role role, const Command& command);
  /// Collects those that have ended.
  void poll();
  bool started(exchange::Role role) const;
  bool running(exchange::Role role) const;
  /// "was killed by signal 9 (Killed)", "ended with exit code 1"; empty while it runs or was never started.
  std::string how_ended(exchange::Role role) const;
  /// Waits up to `seconds` for all to end by themselves. True if they have.
  bool wait(double seconds);
  /// SIGKILLs what still runs.
  void end_all();

 private:
  struct Child {
    pid_t pid = 0;
    std::optional<int> status;  // of waitpid
  };
  std::array<Child, 2> children_{};
};

}  // namespace ballast::launch
