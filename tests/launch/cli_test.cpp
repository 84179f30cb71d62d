// The command from outside: exit codes, messages, and that no process and no shared memory stays behind.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "launch/children.h"

namespace ballast::launch {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// A ball in free fall, written so that rows and formula can be compared.
constexpr const char* kFall = R"(ballast: 1
world: { duration: 0.5 s, spacing: 0.1 }
models:
  - { name: ball, shape: { sphere: { radius: 0.1 } }, density: 500, pose: [0, 0, 10] }
coupling: { engine: free_body }
output: { every: 50 ms }
expect:
  - { column: { of: ball.z, equals: 8.77375 m, within: 5 mm } }
)";

struct Ended {
  int code = -1;
  std::string text;  // standard output and error
};

struct Cli : ::testing::Test {
  fs::path folder = fs::temp_directory_path() / ("ballast_cli_" + std::to_string(getpid()));
  std::string program = std::string(BALLAST_BIN_DIR) + "/ballast_coordinator";

  void SetUp() override {
    fs::create_directories(folder);
    std::ofstream(folder / "fall.yaml") << kFall;
  }
  void TearDown() override { fs::remove_all(folder); }

  std::string scene() const { return (folder / "fall.yaml").string(); }
  std::string out() const { return (folder / "out").string(); }

  Ended call(std::vector<std::string> arguments,
             std::vector<std::pair<std::string, std::string>> environment = {}) const {
    Children children;
    const std::string log = (folder / "log").string();
    const Status started =
        children.start(exchange::Role::kFluid, {program, std::move(arguments), std::move(environment), log});
    EXPECT_TRUE(started);
    EXPECT_TRUE(children.wait(60));
    std::ifstream file(log);
    Ended ended;
    ended.text = {std::istreambuf_iterator<char>(file), {}};
    const std::string how = children.how_ended(exchange::Role::kFluid), words = "ended with exit code ";
    if (how.starts_with(words)) ended.code = std::stoi(how.substr(words.size()));
    return ended;
  }

  nlohmann::json record() const {
    std::ifstream file(folder / "out/record.json");
    return nlohmann::json::parse(file, nullptr, false);
  }
};

TEST_F(Cli, WrongUsageIsCode2WithAMessage) {
  const std::vector<std::vector<std::string>> wrong = {
      {}, {"fly"}, {"run"}, {"run", scene(), "--speed", "9"}, {"run", scene(), "--set", "world.duration"}};
  for (const auto& arguments : wrong) {
    const Ended ended = call(arguments);
    EXPECT_EQ(ended.code, 2) << ended.text;
    EXPECT_FALSE(ended.text.empty());
  }
}

TEST_F(Cli, HelpIsCode0AndNamesTheCommands) {
  const Ended ended = call({"--help"});
  EXPECT_EQ(ended.code, 0);
  for (const char* word : {"run", "check", "resolve", "schema", "plan", "watch", "tap", "spy", "bench"}) {
    EXPECT_NE(ended.text.find(word), std::string::npos) << word;
  }
}

TEST_F(Cli, AMisspeltKeyIsCode2WithItsLine) {
  std::ofstream(folder / "bad.yaml") << "ballast: 1\nworld: { durration: 1 s, spacing: 0.1 }\n";
  const Ended ended = call({"check", (folder / "bad.yaml").string()});
  EXPECT_EQ(ended.code, 2);
  EXPECT_NE(ended.text.find("bad.yaml:2:"), std::string::npos) << ended.text;
  EXPECT_NE(ended.text.find("duration"), std::string::npos) << ended.text;
}

TEST_F(Cli, CheckWarnsOfBodiesThatNoFluidReachesAndOfThoseSmallerThanAParticle) {
  std::ofstream(folder / "odd.yaml") << R"(ballast: 1
world: { dimension: 2, duration: 1 s, spacing: 5 cm }
fluids:
  - { name: water, density: 1000, fill: { box: { min: [0, -0.5, 0], max: [1, 0.5, 0.5] } } }
models:
  - { name: tank, static: true, shape: { open_box: { inside: [1, 1, 1] } } }
  - { name: stray, shape: { box: [0.2, 1, 0.2] }, density: 500, pose: [2, 0, 0.5] }
  - { name: grain, shape: { sphere: { radius: 0.01 } }, density: 500, pose: [0.3, 0, 0.8],
      repeat: { count: [3, 1, 1], step: [0.1, 0, 0] } }
  - { name: above, shape: { box: [0.2, 1, 0.2] }, density: 500, pose: [0.5, 0, 3] }
)";
  const Ended ended = call({"check", (folder / "odd.yaml").string()});
  EXPECT_EQ(ended.code, 0) << ended.text;
  for (const char* word : {"odd.yaml:7:5: the body 'stray' is at (2, 0, 0.5) m, wholly outside every container",
                           "odd.yaml:8:5: the body 'grain_0_0_0' (and 2 more copies) is 0.02 m thick"})
    EXPECT_NE(ended.text.find(word), std::string::npos) << word << " is not in\n" << ended.text;
  EXPECT_EQ(ended.text.find("'above'"), std::string::npos) << "it can fall in\n" << ended.text;
  EXPECT_EQ(ended.text.find("body 'tank'"), std::string::npos) << ended.text;
}

TEST_F(Cli, AFreeFallRunsWithoutFluidAndEndsInFiveLines) {
  const Ended ended = call({"run", scene(), "--out", out()});
  EXPECT_EQ(ended.code, 0) << ended.text;
  EXPECT_NE(ended.text.find("no fluid in this scene: no fluid process"), std::string::npos) << ended.text;
  const auto lines = std::ranges::count(ended.text.substr(ended.text.find("fall: engine")), '\n');
  EXPECT_EQ(lines, 5) << ended.text;
  EXPECT_EQ(record()["exit"], 0);
  EXPECT_TRUE(record()["particles"].is_null());
  // z = 10 - g t^2 / 2 in every row; half a step of the integrator (1 ms) is 2.5 mm at 5 m/s
  std::ifstream rows(folder / "out/bodies.csv");
  std::string line;
  std::getline(rows, line);
  EXPECT_TRUE(line.starts_with("t,ball.x,ball.y,ball.z,ball.qw")) << line;
  int count = 0;
  for (; std::getline(rows, line); ++count) {
    double t = 0, x = 0, y = 0, z = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &x, &y, &z), 4);
    EXPECT_NEAR(z, 10 - 9.81 * t * t / 2, 5e-3);
  }
  EXPECT_GE(count, 11);
}

TEST_F(Cli, AMissedExpectationIsCode3AndListed) {
  const Ended ended = call({"run", scene(), "--out", out(), "--duration", "0.4s"});
  EXPECT_EQ(ended.code, 3) << ended.text;
  EXPECT_NE(ended.text.find("MISSED: ball.z last"), std::string::npos) << ended.text;
  EXPECT_EQ(record()["expect"][0]["pass"], false);
}

TEST_F(Cli, AKilledProcessEndsTheRunWithCode5AndLeavesNothing) {
  const pid_t coordinator = fork();
  const std::string log = (folder / "log").string(), dir = out(), file = scene();
  if (coordinator == 0) {
    if (!std::freopen(log.c_str(), "w", stderr) || !std::freopen("/dev/null", "w", stdout)) _exit(126);
    execl(program.c_str(), "ballast", "run", file.c_str(), "--out", dir.c_str(), "--duration", "1e6 s", nullptr);
    _exit(127);
  }
  pid_t child = 0;
  const std::string children =
      "/proc/" + std::to_string(coordinator) + "/task/" + std::to_string(coordinator) + "/children";
  for (int i = 0; i < 500 && child == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::ifstream(children) >> child;
  }
  ASSERT_GT(child, 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  kill(child, SIGKILL);
  const auto killed = Clock::now();
  int status = 0;
  ASSERT_EQ(waitpid(coordinator, &status, 0), coordinator);
  const double seconds = std::chrono::duration<double>(Clock::now() - killed).count();
  EXPECT_EQ(WEXITSTATUS(status), 5);
  EXPECT_LT(seconds, 1.5);  // 0.5 s on a machine of our own
  std::ifstream text(log);
  const std::string message((std::istreambuf_iterator<char>(text)), {});
  EXPECT_NE(message.find("rigid process"), std::string::npos) << message;
  EXPECT_NE(message.find("signal 9"), std::string::npos) << message;
  for (const auto& entry : fs::directory_iterator("/dev/shm")) {
    EXPECT_EQ(entry.path().string().find("-" + std::to_string(coordinator) + "-"), std::string::npos) << entry.path();
  }
}

TEST_F(Cli, ResolvePrintsASceneThatResolvesToItself) {
  const Ended once = call({"resolve", scene()});
  ASSERT_EQ(once.code, 0) << once.text;
  std::ofstream(folder / "fall.yaml") << once.text;
  EXPECT_EQ(call({"resolve", scene()}).text, once.text);
}

TEST_F(Cli, OneRunAtATimeWritesToAFolder) {
  fs::create_directories(out());
  const int other = open(out().c_str(), O_RDONLY | O_DIRECTORY);
  ASSERT_EQ(flock(other, LOCK_EX), 0);
  const Ended refused = call({"run", scene(), "--out", out()});
  EXPECT_EQ(refused.code, 2) << refused.text;
  EXPECT_NE(refused.text.find("another run writes to " + out()), std::string::npos) << refused.text;
  close(other);
  EXPECT_EQ(call({"run", scene(), "--out", out()}).code, 0);
}

TEST_F(Cli, TheSpySaysWhatItNeeds) {
  const Ended without_java = call({"spy"}, {{"PATH", "/nowhere"}});
  EXPECT_EQ(without_java.code, 2);
  EXPECT_NE(without_java.text.find("apt-get install default-jre"), std::string::npos) << without_java.text;
  const Ended no_url = call({"spy", "--lcm-url", "multicast"});
  EXPECT_EQ(no_url.code, 2);
  EXPECT_NE(no_url.text.find("'multicast' is no LCM URL"), std::string::npos) << no_url.text;
}

TEST_F(Cli, PlanSaysThatMessagesGoOutOnlyWhereAsked) {
  EXPECT_NE(call({"plan", scene()}).text.find("messages over LCM: output.lcm is false"), std::string::npos);
  const std::string asked = call({"plan", scene(), "--set", "output.lcm=true"}).text;
  EXPECT_NE(asked.find("over LCM: status, warnings, bodies\n"), std::string::npos) << asked;
}

TEST_F(Cli, PlanSaysWhatIsLeftOutAndWhy) {
  const Ended ended = call({"plan", scene()});
  EXPECT_EQ(ended.code, 0) << ended.text;
  EXPECT_NE(ended.text.find("fluid process: no fluid in this scene"), std::string::npos) << ended.text;
}

}  // namespace
}  // namespace ballast::launch
