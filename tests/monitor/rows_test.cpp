// Messages as tables, by type information alone.
#include "monitor/rows.h"

#include <gmock/gmock.h>

#include <ballast/body_states_t.hpp>
#include <ballast/particles_t.hpp>
#include <ballast/status_t.hpp>  // and with them LCM's own header of type information
#include <ballast/warning_t.hpp>

#include "msgs/types.h"

namespace ballast::monitor {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <class Message>
std::vector<std::byte> encoded(const Message& message) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

Rows rows(const std::vector<std::byte>& bytes) {
  auto out = rows_of(bytes.data(), bytes.size());
  EXPECT_TRUE(out) << out.error().text();
  return *out;
}

warning_t a_warning() {
  warning_t m;
  m.time = 0.1;
  m.step = 12;
  m.process = "fluid process";
  m.text = "too fast, \"by far\"";
  return m;
}

TEST(Rows, OfAMessageWithoutListsAreOne) {
  const Rows out = rows(encoded(a_warning()));
  EXPECT_EQ(out.type, "warning_t");
  EXPECT_THAT(out.columns, ElementsAre("time", "step", "process", "text"));
  ASSERT_EQ(out.rows.size(), 1u);
  EXPECT_THAT(out.rows[0], ElementsAre("0.1", "12", "fluid process", "too fast, \"by far\""));
}

TEST(Rows, OfAListOfStructsAreItsEntries) {
  body_states_t m{};
  m.time = 1.0 / 3;
  m.count = 2;
  m.bodies.resize(2);
  m.bodies[0].name = "left";
  m.bodies[1].name = "right";
  for (int b = 0; b < 2; ++b) {
    for (int k = 0; k < 3; ++k) m.bodies[b].position[k] = 10 * b + k;
  }
  m.bodies[1].orientation[0] = 1;
  const Rows out = rows(encoded(m));
  ASSERT_EQ(out.rows.size(), 2u);
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::ranges::find(out.columns, name) - out.columns.begin());
  };
  ASSERT_LT(column("bodies.position.z"), out.columns.size());
  EXPECT_EQ(out.rows[0][column("bodies.name")], "left");
  EXPECT_EQ(out.rows[1][column("bodies.name")], "right");
  EXPECT_EQ(out.rows[1][column("bodies.position.z")], "12");
  EXPECT_EQ(out.rows[1][column("bodies.orientation.w")], "1");
  EXPECT_EQ(std::stod(out.rows[1][0]), 1.0 / 3) << "all digits are there";
}

TEST(Rows, OfParallelListsAreTheirEntriesTogether) {
  particles_t m{};
  m.count = 3;
  m.id = {0, 10, 20};
  m.x = m.y = m.z = m.vx = m.vy = m.vz = {0.1f, 0.2f, 0.3f};
  m.pressure = {1, 2, 3};
  const Rows out = rows(encoded(m));
  ASSERT_EQ(out.rows.size(), 3u);
  EXPECT_EQ(out.rows[2].size(), out.columns.size());
  EXPECT_EQ(out.rows[2].back(), "3");
  EXPECT_THAT(out.rows[2], ::testing::Contains("20"));
  EXPECT_THAT(out.rows[2], ::testing::Contains("0.3"));
}

TEST(Rows, OfAnEmptyListAreNone) {
  const body_states_t empty{};
  EXPECT_TRUE(rows(encoded(empty)).rows.empty());
}

TEST(Rows, AreRefusedForBytesThatAreNoMessage) {
  std::vector<std::byte> bytes = encoded(a_warning());
  EXPECT_THAT(rows_of(bytes.data(), 5).error().what, HasSubstr("5 bytes"));
  EXPECT_THAT(rows_of(bytes.data(), bytes.size() - 9).error().what, HasSubstr("warning_t"));
  bytes[0] ^= std::byte{1};
  EXPECT_THAT(rows_of(bytes.data(), bytes.size()).error().what, HasSubstr("unknown"));
}

void put(std::vector<std::byte>& bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t k = 0; k < 4; ++k) bytes[at + k] = static_cast<std::byte>(value >> (24 - 8 * k));
}

/// The generated decoders allocate and read what a message says. Seen before the check: gigabytes for a list, a text
/// read beyond the end of the message.
TEST(Rows, AreRefusedForLengthsThatTheBytesDoNotHave) {
  const std::size_t process = 8 + 8 + 8;  // hash, time, step
  for (const std::uint32_t length : {0u, 3u, 15u, 0x7fffffffu, 0xffffffffu}) {
    std::vector<std::byte> bytes = encoded(a_warning());
    put(bytes, process, length);
    EXPECT_THAT(rows_of(bytes.data(), bytes.size()).error().what, HasSubstr("damaged")) << length;
  }
  std::vector<std::byte> unended = encoded(a_warning());
  unended.back() = std::byte{'!'};
  EXPECT_THAT(rows_of(unended.data(), unended.size()).error().what, HasSubstr("damaged"));
  body_states_t list{};
  list.count = 1;
  list.bodies.resize(1);
  const std::size_t count = 8 + 8 + 8 + 8 + 4 + 4;
  for (const std::uint32_t n : {0u, 2u, 0x0fffffffu, 0x80000000u, 0xffffffffu}) {
    std::vector<std::byte> bytes = encoded(list);
    put(bytes, count, n);
    EXPECT_THAT(rows_of(bytes.data(), bytes.size()).error().what, HasSubstr("damaged")) << n;
  }
}

/// tap gives a row to each entry, so two lists of different lengths in one message could not be shown.
TEST(Rows, FitEveryTypeSinceNoneHasTwoListLengthsOrListsOfLists) {
  int count = 0;
  const ballast_message_type_t* types = ballast_message_types(&count);
  EXPECT_GE(count, 10);
  for (int t = 0; t < count; ++t) {
    SCOPED_TRACE(types[t].name);
    const lcm_type_info_t& info = *types[t].info;
    // With all integers at 1 every list has one entry; a list's own size field is the only way to tell two apart.
    std::vector<std::byte> message(static_cast<std::size_t>(info.struct_size()));
    int sizes = 0;
    bool lists = false;
    for (int i = 0; i < info.num_fields(); ++i) {
      lcm_field_t field{};
      info.get_field(message.data(), i, &field);
      EXPECT_LE(field.num_dim, 1) << field.name;
      lists = lists || (field.num_dim == 1 && field.dim_is_variable[0]);
      if (field.type == LCM_FIELD_INT32_T && std::string(field.name) == "count") ++sizes;
    }
    EXPECT_EQ(sizes, lists ? 1 : 0) << "a list's length is the field `count`";
  }
}

TEST(CsvLine, QuotesWhatWouldBreakTheTable) {
  EXPECT_EQ(csv_line({"a", "1.5", "x,y", "say \"no\"", "two\nlines", ""}),
            "a,1.5,\"x,y\",\"say \"\"no\"\"\",\"two\nlines\",");
}

}  // namespace
}  // namespace ballast::monitor
