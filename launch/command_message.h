// command_t from bytes that anybody may have sent.
#pragma once
#include <cstddef>
#include <optional>

#include "launch/obey.h"

namespace ballast::launch {

/// Decodes an LCM message; nothing if it is no command. The generated decoder trusts the length of the text: a message
/// with a length of 0 or less ends the process.
std::optional<RunCommand> read_command(const void* data, std::size_t size);

}  // namespace ballast::launch
