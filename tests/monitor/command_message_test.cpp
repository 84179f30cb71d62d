// Bytes that anybody may have sent to a run: a command, or nothing.
#include "launch/command_message.h"

#include <gtest/gtest.h>

#include <ballast/command_t.hpp>
#include <string>
#include <vector>

namespace ballast::launch {
namespace {

std::vector<unsigned char> encoded(const std::string& action, std::int64_t steps) {
  command_t message;
  message.action = action;
  message.steps = steps;
  message.body = "crate";
  message.gravity[2] = -1.62;
  std::vector<unsigned char> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

TEST(CommandMessage, IsReadAsItWasWritten) {
  const auto bytes = encoded("step", 12);
  const auto command = read_command(bytes.data(), bytes.size());
  ASSERT_TRUE(command);
  EXPECT_EQ(command->action, "step");
  EXPECT_EQ(command->steps, 12);
  EXPECT_EQ(command->body, "crate");
  EXPECT_EQ(command->gravity[2], -1.62);
}

TEST(CommandMessage, WithAnyByteOfItsLengthWrongIsNone) {
  const auto good = encoded("pause", 1);
  for (const std::size_t at : {8, 9, 10, 11, 34, 35, 36, 37})  // "pause" and its zero, steps and run in between
    for (int value = 0; value < 256; ++value) {
      auto bytes = good;
      if (bytes[at] == value) continue;
      bytes[at] = static_cast<unsigned char>(value);
      EXPECT_FALSE(read_command(bytes.data(), bytes.size())) << at << " " << value;
    }
}

TEST(CommandMessage, CutShortOrTooLongIsNone) {
  auto bytes = encoded("pause", 1);
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(read_command(bytes.data(), size)) << size;
  bytes.push_back(0);
  EXPECT_FALSE(read_command(bytes.data(), bytes.size()));
  const auto endless = encoded(std::string(1000, 'x'), 1);
  EXPECT_FALSE(read_command(endless.data(), endless.size()));
}

/// Anybody may send anything: what is no UTF-8 would make the record impossible to write at the end of the run.
TEST(CommandMessage, WithATextThatCannotBePrintedIsNone) {
  for (const char* text : {"pau\xff", "p\x1b[2J", "p\n", "\xc3\xa4"}) {
    const auto bytes = encoded(text, 1);
    EXPECT_FALSE(read_command(bytes.data(), bytes.size())) << text;
  }
}

TEST(CommandMessage, OfAnotherTypeIsNone) {
  auto bytes = encoded("pause", 1);
  bytes[0] ^= 1;
  EXPECT_FALSE(read_command(bytes.data(), bytes.size()));
}

}  // namespace
}  // namespace ballast::launch
