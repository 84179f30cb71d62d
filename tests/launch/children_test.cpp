// Child processes: environment, the way they end, and that none is left behind.
#include "launch/children.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

namespace ballast::launch {
namespace {

using exchange::Role;

Command shell(const std::string& script) { return {"/bin/sh", {"-c", script}, {{"BALLAST_TEST_WORD", "7"}}, {}}; }

TEST(Children, GetTheEnvironmentAddedAndSayTheirExitCode) {
  Children children;
  ASSERT_TRUE(children.start(Role::kFluid, shell("exit $BALLAST_TEST_WORD")));
  EXPECT_TRUE(children.wait(5));
  EXPECT_EQ(children.how_ended(Role::kFluid), "ended with exit code 7");
}

TEST(Children, ThatAreKilledNameTheSignal) {
  Children children;
  ASSERT_TRUE(children.start(Role::kRigid, shell("kill -SEGV $$")));
  EXPECT_TRUE(children.wait(5));
  EXPECT_NE(children.how_ended(Role::kRigid).find("signal 11"), std::string::npos);
}

TEST(Children, ThatCannotBeStartedAreAnErrorWithTheReason) {
  Children children;
  const Status status = children.start(Role::kFluid, {"/nowhere/fluid_server", {}, {}, {}});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().exit_code, kProcessFailed);
  EXPECT_NE(status.error().what.find("No such file"), std::string::npos);
}

TEST(Children, DoNotOutliveTheirOwner) {
  const auto file = std::filesystem::temp_directory_path() / ("ballast_child_" + std::to_string(getpid()));
  pid_t pid = 0;
  {
    Children children;
    ASSERT_TRUE(children.start(Role::kFluid, shell("echo $$ > " + file.string() + "; exec sleep 60")));
    EXPECT_FALSE(children.wait(0.3));
    std::ifstream(file) >> pid;
    ASSERT_GT(pid, 0);
    ASSERT_EQ(kill(pid, 0), 0);
  }
  EXPECT_NE(kill(pid, 0), 0);
  std::filesystem::remove(file);
}

TEST(Children, HaveAGroupOfTheirOwnSoThatCtrlCReachesTheCoordinatorAlone) {
  Children children;
  ASSERT_TRUE(children.start(Role::kFluid, shell("test $(cut -d\" \" -f5 /proc/$$/stat) = $$ && exit 3")));
  EXPECT_TRUE(children.wait(5));
  EXPECT_EQ(children.how_ended(Role::kFluid), "ended with exit code 3");
}

TEST(Children, EndByASignalThatIsSentToThem) {
  Children children;
  ASSERT_TRUE(children.start(Role::kFluid, shell("kill -TERM $$; exit 3")));
  EXPECT_TRUE(children.wait(5));
  EXPECT_EQ(children.how_ended(Role::kFluid), "was killed by signal 15 (Terminated)");
}

}  // namespace
}  // namespace ballast::launch
