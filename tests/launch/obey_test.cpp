// Commands as bounds on steps, and the record that replays them.
#include "launch/obey.h"

#include <gtest/gtest.h>

namespace ballast::launch {
namespace {

TEST(Obey, SetsNoBoundUnasked) {
  const Obey obey;
  EXPECT_EQ(obey.limit(), std::nullopt);
  EXPECT_FALSE(obey.stop_due(1000));
  EXPECT_TRUE(obey.record().empty());
}

TEST(Obey, PausesStepsAndResumes) {
  Obey obey;
  obey.take({.action = "pause"}, 100, 0.5);
  EXPECT_TRUE(obey.paused());
  EXPECT_EQ(obey.limit(), 100u);
  obey.take({.action = "step", .steps = 3}, 100, 0.5);
  EXPECT_EQ(obey.limit(), 103u);
  obey.take({.action = "step", .steps = 1}, 102, 0.5);  // the last of the three is still under way
  EXPECT_EQ(obey.limit(), 104u);
  obey.take({.action = "resume"}, 104, 0.52);
  EXPECT_FALSE(obey.paused());
  EXPECT_EQ(obey.limit(), std::nullopt);
}

TEST(Obey, CountsAStepThatWasUnderWayAtThePauseAmongTheNext) {
  Obey obey;
  obey.take({.action = "pause"}, 100, 0.5);
  obey.take({.action = "step", .steps = 2}, 101, 0.5);  // 101 had begun
  EXPECT_EQ(obey.limit(), 103u);
}

TEST(Obey, StopsAtOnceAlsoWhilePaused) {
  Obey obey;
  obey.take({.action = "pause"}, 10, 0.1);
  obey.take({.action = "stop"}, 10, 0.1);
  EXPECT_TRUE(obey.stop_due(10));
}

TEST(Obey, RecordsEveryCommandAndWhyItWasRefused) {
  Obey obey;
  obey.take({.action = "resume"}, 1, 0.1);
  obey.take({.action = "step", .steps = 2}, 2, 0.2);
  obey.take({.action = "pause"}, 3, 0.3);
  obey.take({.action = "pause"}, 4, 0.4);
  obey.take({.action = "step", .steps = -1}, 5, 0.5);
  obey.take({.action = "explode"}, 6, 0.6);
  ASSERT_EQ(obey.record().size(), 6u);
  const char* reasons[] = {"not paused", "not paused", nullptr, "paused already", "1 or more", "unknown"};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& entry = obey.record()[i];
    EXPECT_EQ(entry["step"], i + 1);
    EXPECT_EQ(entry.contains("refused"), reasons[i] != nullptr) << entry;
    if (reasons[i] == nullptr) continue;
    EXPECT_NE(entry["refused"].get<std::string>().find(reasons[i]), std::string::npos) << entry;
  }
}

TEST(Obey, CountsAFloodOfRefusedCommands) {
  Obey obey;
  for (std::uint64_t i = 0; i < Obey::kMostRefused + 7; ++i) obey.take({.action = "resume"}, i, 0.1);
  obey.take({.action = "pause"}, 5000, 0.1);
  obey.close();
  ASSERT_EQ(obey.record().size(), Obey::kMostRefused + 2);
  EXPECT_EQ(obey.record()[Obey::kMostRefused]["action"], "pause") << "what is obeyed is always recorded";
  EXPECT_EQ(obey.record().back()["count"], 7);
}

TEST(Obey, ReplaysAStopAfterTheStepOfTheRecord) {
  Obey obey(42);
  EXPECT_EQ(obey.limit(), 42u);
  EXPECT_FALSE(obey.stop_due(41));
  EXPECT_TRUE(obey.stop_due(42));
  obey.take({.action = "pause"}, 40, 0);
  EXPECT_EQ(obey.limit(), 40u);
  obey.take({.action = "step", .steps = 9}, 40, 0);
  EXPECT_EQ(obey.limit(), 42u) << "never beyond the end of the first run";
}

}  // namespace
}  // namespace ballast::launch
