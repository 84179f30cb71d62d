// Runs that are stopped, interrupted, disturbed or started twice end in good order and say what happened.
#include <pty.h>
#include <sys/stat.h>

#include <cstdio>
#include <tuple>

#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using std::chrono::milliseconds;
using Files = std::vector<std::string>;

struct Fault : ::testing::Test {
  Scratch scratch;
};

/// A coupled run that takes `duration` of simulated time; 100 s take a minute and more.
std::vector<std::string> box(const std::string& duration, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {scene("floating_box"), "--duration", duration, "--set", "expect=[]", "--set",
                                    "numerics.relax=false"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

void sleep_ms(int ms) { std::this_thread::sleep_for(milliseconds(ms)); }

/// Waits, at most 30 s, until the children have ended; they stay zombies while their parent is stopped.
bool children_end(const Command& run) {
  for (int i = 0; i < 3000 && !run.attached().empty(); ++i) sleep_ms(10);
  return run.attached().empty();
}

struct Stopped : Fault, ::testing::WithParamInterface<std::tuple<const char*, const char*>> {};

/// A stopped process is alive and silent: the time-out ends the run.
TEST_P(Stopped, ProcessIsNamedAfterTheTimeOut) {
  const auto& [file, victim] = GetParam();
  Command run(scratch.path, {scene(file), "--duration", "10000s", "--set", "expect=[]", "--set", "numerics.relax=false",
                             "--timeout", "1"});
  const std::string name = victim;
  ASSERT_TRUE(run.has_children(std::string(file) == "floating_box" ? 2 : 1)) << run.text();
  sleep_ms(700);  // into the steps
  ASSERT_TRUE(run.children().contains(name)) << run.text();
  kill(run.children().at(name), SIGSTOP);
  EXPECT_EQ(run.wait(), 5) << run.text();
  EXPECT_TRUE(has(run.text(), name == "fluid_server" ? "the fluid process (pid" : "the rigid process (pid"))
      << run.text();
  EXPECT_TRUE(has(run.text(), "is alive but has shown no sign of life for")) << run.text();
  EXPECT_TRUE(has(run.text(), "--timeout")) << run.text();
  EXPECT_TRUE(run.attached().empty());
  EXPECT_EQ(run.left_behind(), Files{});
  EXPECT_EQ(run.record().value("exit", -1), 5);
}

INSTANTIATE_TEST_SUITE_P(
    Processes, Stopped,
    ::testing::Values(std::tuple{"floating_box", "fluid_server"}, std::tuple{"floating_box", "rigid_client"},
                      std::tuple{"dam_break_empty", "fluid_server"}, std::tuple{"pendulum", "rigid_client"}),
    [](const auto& each) { return std::string(std::get<0>(each.param)) + "_" + std::get<1>(each.param); });

/// The two need the coordinator only when their credit of steps is used up.
TEST_F(Fault, AStoppedCoordinatorIsNamedByTheOthersWhichEnd) {
  Command run(scratch.path, box("1000s", {"--timeout", "1"}));
  ASSERT_TRUE(run.has_children(2)) << run.text();
  sleep_ms(500);
  run.send(SIGSTOP);
  EXPECT_TRUE(children_end(run));
  run.send(SIGCONT);
  EXPECT_EQ(run.wait(), 5) << run.text();
  EXPECT_TRUE(has(run.text(), "the coordinator (pid " + std::to_string(run.pid()) + ") is alive but has shown no sign"))
      << run.text();
  EXPECT_EQ(run.left_behind(), Files{});
}

struct Interrupted : Fault, ::testing::WithParamInterface<int> {};

TEST_P(Interrupted, RunKeepsItsRowsAndSaysSo) {
  Command run(scratch.path, box("100s"));
  ASSERT_TRUE(run.has_children(2)) << run.text();
  sleep_ms(700);
  run.send(GetParam());
  EXPECT_EQ(run.wait(), 5) << run.text();
  const std::string name = std::string("SIG") + sigabbrev_np(GetParam());
  EXPECT_TRUE(has(run.text(), "exit 5 (stopped by " + name + ")")) << run.text();
  const nlohmann::json record = run.record();
  EXPECT_EQ(record.value("stopped_by", ""), name);
  EXPECT_EQ(record.value("interrupted", false), true);
  EXPECT_GT(record.value("steps", 0), 0);
  EXPECT_NEAR(run.last_row("bodies.csv")["t"], record.value("simulated_s", -1.0), 1e-8) << "times have nine digits";
  EXPECT_TRUE(run.attached().empty());
  EXPECT_EQ(run.left_behind(), Files{});
}

INSTANTIATE_TEST_SUITE_P(BySignal, Interrupted, ::testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& each) { return std::string(sigabbrev_np(each.param)); });

/// A terminal window is closed: SIGHUP comes, and every word to the terminal fails from then on.
TEST_F(Fault, AClosedTerminalEndsTheRunWithARecord) {
  int terminal = -1;
  const pid_t pid = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (pid == 0) {
    const std::string program = std::string(BALLAST_BIN_DIR) + "/ballast_coordinator", file = scene("floating_box"),
                      out = (scratch.path / "out").string();
    execl(program.c_str(), "ballast", "run", file.c_str(), "--duration", "100s", "--set", "expect=[]", "--out",
          out.c_str(), nullptr);
    _exit(127);
  }
  if (pid < 0 && !fs::exists("/dev/pts/ptmx")) {
    std::puts("no pseudo-terminals here (/dev/pts): not tried");
    return;
  }
  ASSERT_GT(pid, 0);
  for (int i = 0; i < 2000 && !fs::exists(scratch.path / "out/bodies.csv.part"); ++i) sleep_ms(5);
  sleep_ms(1500);
  close(terminal);
  int status = 0;
  ASSERT_EQ(waitpid(pid, &status, 0), pid);
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 5);
  const auto record = nlohmann::json::parse(text_of(scratch.path / "out/record.json"), nullptr, false);
  ASSERT_TRUE(record.is_object()) << "no record";
  EXPECT_EQ(record.value("interrupted", false), true);
  EXPECT_TRUE(fs::exists(scratch.path / "out/bodies.csv"));
}

/// `ballast run SCENE 2>&1 | head`: who reads goes, the run does not.
TEST_F(Fault, AClosedPipeDoesNotEndTheRun) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t pid = fork();
  if (pid == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    close(ends[1]);
    const std::string program = std::string(BALLAST_BIN_DIR) + "/ballast_coordinator", file = scene("floating_box"),
                      out = (scratch.path / "out").string();
    // four times too fast for the water: it warns
    execl(program.c_str(), "ballast", "run", file.c_str(), "--duration", "50ms", "--set", "expect=[]", "--set",
          "models.box.velocity=[0, 0, -8]", "--set", "numerics.sound_speed=20", "--out", out.c_str(), nullptr);
    _exit(127);
  }
  close(ends[0]);
  close(ends[1]);
  int status = 0;
  ASSERT_EQ(waitpid(pid, &status, 0), pid);
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  const auto record = nlohmann::json::parse(text_of(scratch.path / "out/record.json"), nullptr, false);
  ASSERT_TRUE(record.is_object()) << "no record";
  EXPECT_FALSE(record["warnings"].empty()) << "this test had no power: nothing was written to the pipe";
}

TEST_F(Fault, AnEditOfTheSceneDuringTheRunChangesNothing) {
  const fs::path file = scratch.path / "edited.yaml";
  std::vector<nlohmann::json> records;
  for (bool edit : {false, true}) {
    fs::remove(file);
    fs::copy_file(scene("floating_box"), file);
    Command run(scratch.path, {file.string(), "--duration", "0.3s", "--set", "expect=[]"});
    ASSERT_TRUE(run.has_children(2)) << run.text();
    if (edit) std::ofstream(file) << "ballast: 2\nnonsense\n";
    EXPECT_EQ(run.wait(), 0) << run.text();
    records.push_back(run.record());
  }
  for (const char* key : {"scene_hash", "state_hash"}) EXPECT_EQ(records[0][key], records[1][key]) << key;
}

TEST_F(Fault, TwoRunsAtOnceDoNotDisturbEachOther) {
  const fs::path other = scratch.path / "other";
  fs::create_directories(other);
  Command first(scratch.path, box("0.2s")), second(other, box("0.2s"));
  EXPECT_EQ(first.wait(), 0) << first.text();
  EXPECT_EQ(second.wait(), 0) << second.text();
  EXPECT_EQ(first.record()["state_hash"], second.record()["state_hash"]);
}

TEST_F(Fault, ASecondRunIntoTheSameFolderIsRefused) {
  Command first(scratch.path, box("0.5s"));
  ASSERT_TRUE(first.has_children(2)) << first.text();
  const fs::path log = scratch.path / "second";
  const std::string line = std::string(BALLAST_BIN_DIR) + "/ballast_coordinator run " + scene("floating_box") +
                           " --out " + (scratch.path / "out").string() + " >" + log.string() + " 2>&1";
  const int status = std::system(line.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_TRUE(has(text_of(log), "another run writes to")) << text_of(log);
  EXPECT_TRUE(has(text_of(log), "--out")) << text_of(log);
  EXPECT_EQ(first.wait(), 0) << first.text();
}

/// What a run that was started by hand leaves when its coordinator is killed before the others came.
TEST_F(Fault, TheSegmentOfACrashedRunIsRemovedByTheNext) {
  Command crashed(scratch.path, box("100s", {"--by-hand"}));
  for (int i = 0; i < 2000 && !has(crashed.text(), "rigid_client"); ++i) sleep_ms(5);
  crashed.send(SIGKILL);
  EXPECT_EQ(crashed.wait(), -SIGKILL);
  ASSERT_EQ(crashed.left_behind().size(), 1u) << crashed.text();
  const std::string name = crashed.left_behind()[0];
  // Neither is stale: one that belongs to a process that lives, one that is not ours to judge.
  const std::string own = "/dev/shm/ballast-" + std::to_string(geteuid()) + "-",
                    living = own + std::to_string(getpid()) + "-0";
  const std::string others = "/dev/shm/ballast-" + std::to_string(geteuid() + 1) + "-1-0";
  for (const std::string& file : {living, others}) std::ofstream(file) << "not yet";
  Command next(scratch.path, box("10ms"));
  EXPECT_EQ(next.wait(), 0) << next.text();
  EXPECT_TRUE(has(next.text(), "removed /dev/shm/" + name)) << next.text();
  EXPECT_EQ(crashed.left_behind(), Files{});
  for (const std::string& file : {living, others}) {
    EXPECT_TRUE(fs::remove(file)) << file << " is gone";
    EXPECT_FALSE(has(next.text(), file)) << next.text();
  }
}

}  // namespace
}  // namespace ballast::testing
