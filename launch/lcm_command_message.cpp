// Checks the two lengths in the message, then lets the generated decoder do the rest.
#include <algorithm>
#include <ballast/command_t.hpp>

#include "launch/command_message.h"

namespace ballast::launch {

namespace {

constexpr std::size_t kHash = 8, kStepsAndRun = 8 + 8, kNumbers = 8 * (3 + 3 + 1 + 3 + 4 + 3), kLongest = 64;

/// Bytes of a text at `at` as lcm-gen writes it: length with its zero (4, big-endian), text, zero. Nothing if it does
/// not end within `size`, or holds what no action and no name of a scene has: it goes into the record, which is JSON,
/// and onto the terminal.
std::optional<std::size_t> text(const unsigned char* bytes, std::size_t at, std::size_t size) {
  if (at + 4 > size) return std::nullopt;
  std::size_t length = 0;
  for (std::size_t k = 0; k < 4; ++k) length = length << 8 | bytes[at + k];
  if (length < 1 || length > kLongest || at + 4 + length > size || bytes[at + 3 + length] != 0) return std::nullopt;
  const unsigned char* begin = bytes + at + 4;
  const auto readable = [](unsigned char c) { return c >= ' ' && c <= '~'; };
  if (!std::all_of(begin, begin + length - 1, readable)) return std::nullopt;
  return 4 + length;
}

}  // namespace

std::optional<RunCommand> read_command(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  const auto action = text(bytes, kHash, size);
  if (!action) return std::nullopt;
  const std::size_t second = kHash + *action + kStepsAndRun;
  const auto body = text(bytes, second, size);
  if (!body || second + *body + kNumbers != size) return std::nullopt;
  command_t message;
  if (message.decode(data, 0, static_cast<int>(size)) != static_cast<int>(size)) return std::nullopt;
  RunCommand c{message.action, message.steps, message.run, message.body};
  c.duration = message.duration;
  std::ranges::copy(message.force, c.force.begin());
  std::ranges::copy(message.torque, c.torque.begin());
  std::ranges::copy(message.position, c.position.begin());
  std::ranges::copy(message.orientation, c.orientation.begin());
  std::ranges::copy(message.gravity, c.gravity.begin());
  return c;
}

}  // namespace ballast::launch
