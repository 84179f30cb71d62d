// Any bytes on the channel of commands are a command or none; what they ask for is obeyed or refused with a reason.
#include <cstdint>
#include <cstdlib>

#include "launch/command_message.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static ballast::launch::Obey obey;
  static std::uint64_t taken = 0;
  const auto command = ballast::launch::read_command(data, size);
  if (!command) return 0;
  if (++taken % 1000 == 0) obey = ballast::launch::Obey();
  obey.take(*command, taken, 0);
  if (obey.paused() != obey.limit().has_value()) std::abort();
  // The record is JSON whatever the text was.
  if (nlohmann::json::parse(obey.record().back().dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))
          .is_null())
    std::abort();
  return 0;
}
