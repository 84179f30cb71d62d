// In place of publish.cpp where LCM is not installed: asking for it is an error, everything else works.
#include "launch/publish.h"

namespace ballast::launch {

struct Publisher::Worker {};

Status Publisher::available() {
  return Error{
      "this build of Ballast has no LCM, so it cannot send messages",
      "apt-get install liblcm-dev liblcm-bin, then `touch CMakeLists.txt` and start again: the build finds them",
      "--lcm"};
}
std::uint32_t Publisher::frames_wanted(const Scene&) { return 0; }
Result<std::unique_ptr<Publisher>> Publisher::make(const Prepared&, const std::string&) { return available().error(); }
Publisher::~Publisher() = default;
void Publisher::take(exchange::Role, exchange::Frame&&) {}
void Publisher::status(const RunStatus&) {}
nlohmann::json Publisher::close(const RunStatus&) { return nullptr; }

}  // namespace ballast::launch
