// In place of publish*.cpp and lcm_*.cpp where LCM is not installed: asking for it is an error, everything else
// works.
#include <fmt/format.h>

#include "launch/doctor.h"
#include "launch/lcm_commands.h"
#include "launch/publish.h"

namespace ballast::launch {

struct Publisher::Worker {};

Status Publisher::available() {
  return Error{
      "this build of Ballast has no LCM, so it cannot send messages",
      "apt-get install liblcm-dev liblcm-bin, then `touch CMakeLists.txt` and start again: the build finds them",
      "--lcm"};
}
std::uint32_t Publisher::frames_wanted(const Prepared&) { return 0; }
Result<std::unique_ptr<Publisher>> Publisher::make(const Prepared&, const std::string&,
                                                   std::function<Clock::time_point()>) {
  return available().error();
}
Publisher::~Publisher() = default;
void Publisher::take(exchange::Role, exchange::Frame&&) {}
void Publisher::status(const RunStatus&) {}
nlohmann::json Publisher::close(const RunStatus&) { return nullptr; }

struct CommandListener::Worker {};
Result<std::unique_ptr<CommandListener>> CommandListener::make(const std::string&) {
  return Publisher::available().error();
}
CommandListener::~CommandListener() = default;
std::vector<RunCommand> CommandListener::take() { return {}; }
Result<std::string> lcm_round_trip() { return Publisher::available().error(); }
int tell(const RunCommand&, const std::string&) {
  fmt::print(stderr, "ballast: {}\n", Publisher::available().error().text());
  return kBadInput;
}

}  // namespace ballast::launch
