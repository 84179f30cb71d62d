// Checks the one length in the message, then lets the generated decoder do the rest.
#include <ballast/command_t.hpp>

#include "launch/command_message.h"

namespace ballast::launch {

namespace {

// As lcm-gen writes it, big-endian: hash (8), length of the text with its zero (4), text, zero, steps (8).
constexpr std::size_t kBefore = 12, kAfter = 8, kLongest = 64;

}  // namespace

std::optional<RunCommand> read_command(const void* data, std::size_t size) {
  if (size < kBefore + 1 + kAfter || size > kBefore + kLongest + kAfter) return std::nullopt;
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::size_t length = 0;
  for (std::size_t k = 8; k < kBefore; ++k) length = length << 8 | bytes[k];
  if (length != size - kBefore - kAfter || bytes[kBefore + length - 1] != 0) return std::nullopt;
  command_t message;
  if (message.decode(data, 0, static_cast<int>(size)) != static_cast<int>(size)) return std::nullopt;
  return RunCommand{message.action, message.steps};
}

}  // namespace ballast::launch
