// Parts of checkpoints: what is written comes back to the bit; what is cut, changed or foreign is refused with its
// name.
#include "common/checkpoint/part.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "common/checkpoint/state.h"

namespace ballast::checkpoint {
namespace {

namespace fs = std::filesystem;

struct Plain {
  double a;
  std::uint32_t b, c;
};

struct Inner {
  std::vector<Plain> list;
  template <class A>
  void state(A& a) {
    a("list", list);
  }
};

struct Everything {
  double number = 0, infinite = 0, nan = 0, tiny = 0;
  std::uint64_t big = 0;
  std::int64_t negative = 0;
  bool flag = false;
  std::string text;
  std::vector<std::string> texts;
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> vectors;
  std::vector<float> floats;
  Inner inner;
  template <class A>
  void state(A& a) {
    a("number", number), a("infinite", infinite), a("nan", nan), a("tiny", tiny), a("big", big);
    a("negative", negative), a("flag", flag), a("text", text), a("texts", texts), a("vector", vector);
    a("vectors", vectors), a("floats", floats), a("inner", inner);
  }
};

struct Part : ::testing::Test {
  std::string folder =
      (fs::temp_directory_path() / ("ballast_checkpoint_" + std::to_string(getpid())) / "000000000007").string();
  void TearDown() override { fs::remove_all(fs::path(folder).parent_path()); }

  std::string bytes(const std::string& name) const {
    std::ifstream file(folder + "/" + name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void put(const std::string& name, const std::string& content) const {
    std::ofstream(folder + "/" + name, std::ios::binary) << content;
  }
  std::string refusal(const std::string& name) const {
    const auto read = read_part(folder, name);
    return read ? "it was read" : read.error().what;
  }
};

TEST_F(Part, BringsEveryKindOfValueBackToTheLastBit) {
  Everything out;
  out.number = 0.1 + 0.2, out.infinite = std::numeric_limits<double>::infinity();
  out.nan = std::numeric_limits<double>::quiet_NaN(), out.tiny = std::numeric_limits<double>::denorm_min();
  out.big = ~0ULL - 1, out.negative = -5, out.flag = true, out.text = "fluid \n µ", out.texts = {"", "b"};
  out.vector = {1e-300, -0.0, 3}, out.vectors = {{1, 2, 3}, {4, 5, 1.0 / 3}}, out.floats = {0.1f, -0.f};
  out.inner.list = {{0.7, 1, 2}, {-0.7, 3, 4}};
  ASSERT_TRUE(write_part(folder, "x", save(out)));
  auto content = read_part(folder, "x");
  ASSERT_TRUE(content) << content.error().text();
  Everything in;
  const Status restored = restore(*content, in);
  ASSERT_TRUE(restored) << restored.error().text();
  EXPECT_EQ(in.number, 0.1 + 0.2);
  EXPECT_EQ(in.infinite, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(in.nan));
  EXPECT_EQ(in.tiny, std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(in.big, ~0ULL - 1);
  EXPECT_EQ(in.negative, -5);
  EXPECT_TRUE(in.flag);
  EXPECT_EQ(in.text, "fluid \n µ");
  EXPECT_EQ(in.texts, (std::vector<std::string>{"", "b"}));
  EXPECT_EQ(in.vector, Eigen::Vector3d(1e-300, 0, 3));
  EXPECT_TRUE(std::signbit(in.vector[1]));
  EXPECT_EQ(in.vectors[1][2], 1.0 / 3);
  EXPECT_EQ(in.floats[0], 0.1f);
  EXPECT_TRUE(std::signbit(in.floats[1]));
  ASSERT_EQ(in.inner.list.size(), 2u);
  EXPECT_EQ(in.inner.list[1].a, -0.7);
  EXPECT_EQ(in.inner.list[1].c, 4u);
}

TEST_F(Part, IsRefusedWhereverItIsCutAndWhicheverByteIsChanged) {
  ASSERT_TRUE(write_part(folder, "x", {{"step", 7}, {"text", "some content"}}));
  const std::string whole = bytes("x");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    put("x", whole.substr(0, length));
    EXPECT_NE(refusal("x"), "it was read") << length << " bytes of " << whole.size();
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    put("x", changed);
    EXPECT_NE(refusal("x"), "it was read") << "byte " << at;
  }
  put("x", whole);
  EXPECT_EQ(refusal("x"), "it was read");
}

TEST_F(Part, SaysWhichFileIsMissingOrForeign) {
  EXPECT_NE(refusal("fluid").find("000000000007/fluid: this part of the checkpoint is missing"), std::string::npos);
  fs::create_directories(folder);
  put("fluid", "a text that somebody wrote into this place");
  EXPECT_NE(refusal("fluid").find("no part of a checkpoint"), std::string::npos) << refusal("fluid");
}

TEST_F(Part, OfAnotherFormatIsRefusedByItsNumber) {
  ASSERT_TRUE(write_part(folder, "x", {{"step", 7}}));
  std::string other = bytes("x");
  other[8] = 99;  // the format follows the magic of 8 bytes
  put("x", other);
  EXPECT_NE(refusal("x").find("format 99"), std::string::npos) << refusal("x");
}

TEST_F(Part, LeavesNothingHalfWrittenUnderItsName) {
  ASSERT_TRUE(write_part(folder, "x", {{"step", 7}}));
  EXPECT_FALSE(fs::exists(folder + "/x.part"));
  fs::create_directories(folder + "/y.part");  // the way is barred: nothing can be written there
  EXPECT_FALSE(write_part(folder, "y", {{"step", 7}}));
  EXPECT_FALSE(fs::exists(folder + "/y"));
}

TEST(State, NamesTheFirstMemberThatDoesNotFit) {
  Everything in;
  Json content = save(in);
  content.erase("tiny");
  const Status missing = restore(content, in);
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().what.find("no 'tiny'"), std::string::npos) << missing.error().what;
  content = save(in);
  content["vector"] = Json::binary({1, 2, 3});
  EXPECT_NE(restore(content, in).error().what.find("'vector'"), std::string::npos);
  content = save(in);
  content["inner"]["list"] = 5;
  EXPECT_NE(restore(content, in).error().what.find("'list'"), std::string::npos);
}

TEST(Due, IsWhereTimeCrossesAMultipleAndGoesOnAlikeAfterARestart) {
  Due due(0.1);
  EXPECT_FALSE(due.at(0.05));
  EXPECT_TRUE(due.at(0.1));
  EXPECT_FALSE(due.at(0.15));
  EXPECT_TRUE(due.at(0.37));
  EXPECT_FALSE(due.at(0.39));
  Due resumed(0.1, 0.37);
  EXPECT_FALSE(resumed.at(0.39));
  EXPECT_TRUE(resumed.at(0.41));
  Due never;
  EXPECT_FALSE(never.at(1e9));
}

}  // namespace
}  // namespace ballast::checkpoint
