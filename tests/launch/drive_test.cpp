// The coordinator's loop with scripted processes: forked children that speak the protocol, or break it.
#include "launch/drive.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/output/columns.h"

namespace ballast::launch {
namespace {

using exchange::FrameKind;
using exchange::Role;
using exchange::Segment;
using Clock = std::chrono::steady_clock;

constexpr const char* kDrop = R"(
ballast: 1
world: { duration: 1 s, spacing: 0.1 }
fluids:
  - { name: water, material: water, fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } } }
models:
  - { name: ball, shape: { sphere: { radius: 0.1 } }, density: 500, pose: [0.5, 0.5, 0.9] }
)";

Prepared make_prepared(bool fluid, bool rigid) {
  auto scene = read_scene_text(kDrop, "test.yaml");
  EXPECT_TRUE(scene) << scene.error().text();
  auto bodies = make_bodies(*scene);
  EXPECT_TRUE(bodies);
  return {std::move(*scene), std::move(*bodies), fluid, rigid, {}};
}

/// What a scripted process does wrong, and at which step.
struct Script {
  std::uint64_t die_at = 0, wrong_hash_at = 0, fail_at = 0;
  int steps = 50;
};

/// One process of a run: attaches, reports steps as credit allows, finishes. Runs in a forked child.
int play(const std::string& name, Role role, const Script& script) {
  auto segment = Segment::attach(name, role);
  if (!segment) return 1;
  exchange::Link link(*segment, role);
  std::vector<double> row(output::kBodyValues, 1.0 / 3);
  for (std::uint64_t step = 1; step <= static_cast<std::uint64_t>(script.steps); ++step) {
    auto go = link.await_credit(step);
    if (!go) return 1;
    if (!*go) break;
    if (step == script.die_at) raise(SIGKILL);
    if (step == script.fail_at) {
      (void)link.finish(kDiverged, R"({"failure": "the density left its bounds"})");
      return kDiverged;
    }
    exchange::StepReport report{};
    report.step = step;
    report.time = 0.02 * static_cast<double>(step);
    report.dt = 0.02;
    report.hash = step == script.wrong_hash_at ? 99 : step;
    if (!link.report(report)) return 1;
    if (role == Role::kRigid && !link.frame(FrameKind::kBodies, step, report.time, row)) return 1;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return link.finish(kFine, R"({"state_hash": "1"})") ? 0 : 1;
}

struct Drive : ::testing::Test {
  std::string out = (std::filesystem::temp_directory_path() / ("ballast_drive_" + std::to_string(getpid()))).string();
  std::vector<pid_t> pids;
  Table bodies;
  std::uint64_t steps = 0;
  double seconds = 0;
  bool segment_left = false;

  void SetUp() override { std::filesystem::create_directories(out); }
  void TearDown() override {
    for (pid_t pid : pids) {
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
    std::filesystem::remove_all(out);
  }

  void fork_player(const std::string& name, Role role, const Script& script) {
    const pid_t pid = fork();
    if (pid == 0) _exit(play(name, role, script));
    pids.push_back(pid);
  }

  Outcome run(const Script& fluid, const Script& rigid, std::optional<std::uint64_t> stop_after = {}) {
    const Prepared prepared = make_prepared(true, true);
    const std::string name = Segment::make_name();
    Outcome outcome;
    {
      exchange::SegmentPlan plan;
      plan.manifest = make_manifest(prepared.scene, prepared.bodies);
      plan.scene_text = print_scene(prepared.scene);
      plan.out_dir = out;
      auto segment = Segment::create(name, plan);
      EXPECT_TRUE(segment);
      fork_player(name, Role::kFluid, fluid);
      fork_player(name, Role::kRigid, rigid);
      auto collector = Collector::make(prepared.scene, true, true, out);
      EXPECT_TRUE(collector);
      Children none;
      const auto start = Clock::now();
      outcome = drive(*segment, none, prepared, *collector, {.by_hand = true, .quiet = true, .stop_after = stop_after});
      seconds = std::chrono::duration<double>(Clock::now() - start).count();
      EXPECT_TRUE(collector->close());
      bodies = collector->bodies();
      steps = collector->reported();
    }
    segment_left = std::filesystem::exists("/dev/shm/" + name);
    return outcome;
  }
};

TEST_F(Drive, CollectsEveryStepAndRowOfARunThatGoesWell) {
  const Outcome outcome = run({}, {});
  EXPECT_EQ(outcome.exit, kFine) << outcome.message;
  EXPECT_EQ(steps, 50u);
  EXPECT_EQ(bodies.rows(), 50u);
  EXPECT_EQ(outcome.fluid["state_hash"], "1");
  EXPECT_FALSE(segment_left);
  EXPECT_TRUE(std::filesystem::exists(out + "/bodies.csv"));
  EXPECT_FALSE(std::filesystem::exists(out + "/bodies.csv.part"));
  std::ifstream file(out + "/bodies.csv");
  std::string line;
  for (std::string next; std::getline(file, next);) line = next;
  EXPECT_TRUE(line.starts_with("1,")) << line;
  EXPECT_EQ(std::stod(line.substr(line.rfind(',') + 1)), 1.0 / 3) << "a double comes back to the last bit: " << line;
}

TEST_F(Drive, EndsWithCode5AndANameWhenAProcessIsKilled) {
  const Outcome outcome = run({}, {.die_at = 20});
  EXPECT_EQ(outcome.exit, kProcessFailed);
  EXPECT_NE(outcome.message.find("rigid process"), std::string::npos) << outcome.message;
  EXPECT_LT(seconds, 2);  // 20 steps of 1 ms, peer test in 100 ms, grace 0.3 s, and a machine that is shared
  EXPECT_FALSE(segment_left);
}

TEST_F(Drive, EndsWithCode5WhenTheProcessesDisagreeOnTheBodies) {
  const Outcome outcome = run({}, {.wrong_hash_at = 30});
  EXPECT_EQ(outcome.exit, kProcessFailed);
  EXPECT_NE(outcome.message.find("step 30"), std::string::npos) << outcome.message;
}

TEST_F(Drive, PassesOnTheCodeAndTheWordsOfAProcessThatFails) {
  const Outcome outcome = run({.fail_at = 10}, {});
  EXPECT_EQ(outcome.exit, kDiverged);
  EXPECT_NE(outcome.message.find("the density left its bounds"), std::string::npos) << outcome.message;
}

TEST_F(Drive, EndsAReplayAfterTheStepOfTheRecord) {
  const Outcome outcome = run({.steps = 100000}, {.steps = 100000}, 20);
  EXPECT_EQ(outcome.exit, kFine) << outcome.message;
  EXPECT_FALSE(outcome.interrupted);
  EXPECT_EQ(outcome.stopped_after, 20u);
  EXPECT_EQ(steps, 20u);
}

TEST_F(Drive, StopsInGoodOrderOnSigterm) {
  std::thread interrupt([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    kill(getpid(), SIGTERM);
  });
  const Outcome outcome = run({.steps = 100000}, {.steps = 100000});
  interrupt.join();
  EXPECT_TRUE(outcome.interrupted);
  EXPECT_EQ(outcome.message, "stopped by SIGTERM");
  EXPECT_EQ(outcome.exit, kProcessFailed);
  EXPECT_GT(steps, 0u);
  EXPECT_LT(seconds, 3);
  EXPECT_TRUE(std::filesystem::exists(out + "/bodies.csv"));
}

}  // namespace
}  // namespace ballast::launch
