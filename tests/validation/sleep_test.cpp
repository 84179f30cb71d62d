// Runs that sleep: what they change against the same run awake, what wakes them, and that neither threads, checkpoints
// nor replays change a bit.
#include <cmath>
#include <sstream>

#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

/// A block on a shelf over shallow water, in a tank on the floor; a paddle that moves from 1.5 to 1.6 s.
constexpr const char* kTank = R"(ballast: 1
world: { dimension: 2, duration: 2.4 s, spacing: 5 cm, accuracy: interactive, sleep: { speed: 5 cm/s, after: 0.2 s } }
fluids:
  - { name: water, material: water, fill: { box: { min: [0, -1, 0], max: [1, 1, 0.3] } } }
models:
  - { name: tank, static: true, shape: { open_box: { inside: [1, 1, 0.8] } } }
  - { name: block, shape: { box: [0.2, 1, 0.2] }, density: 3000, pose: [0.5, 0, 0.1] }
  - { name: paddle, prescribed: { velocity: [0, 0, -0.4], start: 1.5 s, stop: 1.6 s }, shape: { box: [0.2, 1, 0.2] },
      pose: [0.15, 0, 0.5] }
output: { every: 20 ms }
probes:
  - { name: level, level_at: [0.8, 0] }
)";

constexpr const char* kDry = R"(ballast: 1
world: { duration: 3 s, sleep: { speed: 1 mm/s, after: 0.3 s } }
models:
  - { name: floor, static: true, shape: { plane: { normal: [0, 0, 1] } } }
  - { name: ball, shape: { sphere: { radius: 0.1 } }, mass: 2 kg, restitution: 0, pose: [0, 0, 0.1] }
coupling: { rigid_step: 1 ms }
)";

struct Sleep : ::testing::Test {
  Scratch scratch;
  std::string write(const char* name, const char* text) const {
    std::ofstream(scratch.path / name) << text;
    return (scratch.path / name).string();
  }
  std::string replay(const json& command) const {
    return write("replay.json", json{{"commands", json::array({command})}}.dump().c_str());
  }
  json run(const char* folder, Words words) const {
    fs::create_directories(scratch.path / folder);
    Command command(scratch.path / folder, std::move(words));
    EXPECT_EQ(command.wait(), 0) << command.text();
    return command.record();
  }
  /// A column of a table as numbers.
  std::vector<double> column(const char* folder, const char* file, const std::string& name) const {
    std::istringstream lines(text_of(scratch.path / folder / "out" / file));
    std::string line, cell;
    std::getline(lines, line);
    std::istringstream heads(line);
    std::size_t wanted = 0;
    for (; std::getline(heads, cell, ',') && cell != name;) ++wanted;
    std::vector<double> out;
    while (std::getline(lines, line)) {
      std::istringstream cells(line);
      for (std::size_t k = 0; k <= wanted; ++k) std::getline(cells, cell, ',');
      out.push_back(std::stod(cell));
    }
    return out;
  }
};

TEST_F(Sleep, StopsBeforeAPaddleMovesAndNoRowIsMissing) {
  const std::string tank = write("tank.yaml", kTank);
  const json asleep = run("a", {tank}), awake = run("b", {tank, "--set", "world.sleep.speed=0"});
  EXPECT_FALSE(awake.contains("sleep"));
  ASSERT_GE(asleep["sleep"]["naps"].size(), 2u) << asleep["sleep"];
  EXPECT_DOUBLE_EQ(asleep["sleep"]["naps"][0]["to"], 1.5);
  EXPECT_GT(asleep["sleep"]["naps"][1]["from"], 1.6);
  EXPECT_EQ(asleep["step_limits"]["asleep"], asleep["sleep"]["steps"]);
  EXPECT_LT(asleep["steps"], awake["steps"]);
  const auto times = column("a", "bodies.csv", "t"), others = column("b", "bodies.csv", "t");
  ASSERT_EQ(times.size(), others.size());
  // Each comes with the first step that ends after it falls due, and before the next one does.
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_EQ(std::floor(times[k] / 0.02 + 1e-6), k) << times[k];
  // The paddle is where its motion says, asleep or not.
  for (const char* folder : {"a", "b"}) EXPECT_NEAR(column(folder, "bodies.csv", "paddle.z").back(), 0.46, 1e-9);
}

TEST_F(Sleep, ChangesPosesAndLevelByLessThanItsBound) {
  const std::string tank = write("tank.yaml", kTank);
  const json asleep = run("a", {tank, "--duration", "1.4s"});
  const json awake = run("b", {tank, "--duration", "1.4s", "--set", "world.sleep.speed=0"});
  ASSERT_GT(asleep["sleep"]["asleep_s"], 0.5) << asleep["sleep"];
  const double bound = asleep["sleep"]["bound_m"];
  EXPECT_DOUBLE_EQ(bound, 0.05 * asleep["sleep"]["asleep_s"].get<double>());
  EXPECT_LE(asleep["sleep"]["drift_m"], bound) << "slower than asked for when it fell asleep";
  for (const char* name : {"block.x", "block.z"})
    EXPECT_NEAR(column("a", "bodies.csv", name).back(), column("b", "bodies.csv", name).back(), bound) << name;
  EXPECT_NEAR(column("a", "probes.csv", "level").back(), column("b", "probes.csv", "level").back(), bound);
  EXPECT_NE(asleep["state_hash"], awake["state_hash"]) << "this test has no power";
}

TEST_F(Sleep, WithABoundThatNothingReachesChangesNoBit) {
  const std::string tank = write("tank.yaml", kTank);
  const json never = run("a", {tank, "--duration", "0.8s", "--set", "world.sleep.speed=1e-9"});
  const json off = run("b", {tank, "--duration", "0.8s", "--set", "world.sleep.speed=0"});
  EXPECT_EQ(never["sleep"]["steps"], 0);
  EXPECT_EQ(never["state_hash"], off["state_hash"]);
  EXPECT_EQ(never["ledger"], off["ledger"]);
}

TEST_F(Sleep, IsTheSameWithOtherThreadsFromACheckpointAndInAReplay) {
  const std::string tank = write("tank.yaml", kTank);
  const std::string commands = replay(at(1200, {{"action", "wrench"},
                                                {"body", "block"},
                                                {"force_N", {200, 0, 0}},
                                                {"torque_N_m", {0, 0, 0}},
                                                {"duration_s", 0.05}}));
  const json first = run("a", {tank, "--threads", "1", "--replay", commands});
  ASSERT_EQ(first["commands"].size(), 1u);
  const json second = run("b", {tank, "--threads", "3", "--checkpoint", "0.6s", "--replay", commands});
  fs::create_directories(scratch.path / "c");
  const json resumed = run("c", {"--resume", (scratch.path / "b/out").string(), "--replay", commands});
  ASSERT_GT(resumed["resumed"]["time_s"], 1.1);
  for (const json* other : {&second, &resumed}) {
    for (const char* key : {"state_hash", "steps", "ledger", "step_limits"})
      EXPECT_EQ((*other)[key], first[key]) << key;
    for (const char* key : {"naps", "asleep_s", "steps"}) EXPECT_EQ((*other)["sleep"][key], first["sleep"][key]) << key;
  }
  EXPECT_EQ(text_of(scratch.path / "c/out/bodies.csv"), text_of(scratch.path / "a/out/bodies.csv"));
}

TEST_F(Sleep, GivesAndReceivesTheSameMomentumInRowsAndLedger) {
  const json record = run("a", {write("tank.yaml", kTank), "--duration", "1.4s"});
  ASSERT_GT(record["sleep"]["asleep_s"], 0.5);
  EXPECT_EQ(record["ledger"]["imbalance_relative"], 0.0);
}

TEST_F(Sleep, OfBodiesAloneEndsWithAPushAndTheFormulaForIt) {
  // The ball lies still for 1 s, then 4 N act for 0.1 s on 2 kg; upwards 30 N less 19.62 N of weight.
  const std::string dry = write("dry.yaml", kDry);
  const json push = {
      {"action", "wrench"}, {"body", "ball"}, {"force_N", {0, 0, 30}}, {"torque_N_m", {0, 0, 0}}, {"duration_s", 0.1}};
  const json record = run("a", {dry, "--replay", replay(at(1000, push)), "--duration", "1.15s"});
  ASSERT_EQ(record["sleep"]["naps"].size(), 1u) << record["sleep"];
  EXPECT_NEAR(record["sleep"]["naps"][0]["from"].get<double>(), 0.3, 2e-3);
  EXPECT_NEAR(record["sleep"]["naps"][0]["to"].get<double>(), 1.0, 1e-9);
  const double speed = (30 / 2.0 - 9.81) * 0.1 - 9.81 * 0.05;
  EXPECT_NEAR(column("a", "bodies.csv", "ball.vz").back(), speed, 1e-9);
  EXPECT_EQ(record["steps"], 1150) << "steps keep their length";
}

TEST_F(Sleep, IsInTheTableOfWhatWasLeftOut) {
  const json record = run("a", {write("tank.yaml", kTank), "--duration", "1.4s"});
  json row;
  for (const json& each : record["left_out"])
    if (each["what"] == "steps asleep") row = each;
  ASSERT_TRUE(row.is_object()) << record["left_out"];
  EXPECT_GT(row["saved_s"], 0);
  EXPECT_NE(row["difference"].get<std::string>().find("bound"), std::string::npos);
  const std::string motor =
      "joints=[{name: winch, type: revolute, parent: world, child: block, anchor: [0.5, 0, 0.1], axis: [0, 1, 0],"
      " motor: {velocity: 1e-4, max_effort: 1e-3}}]";
  const json awake = run("b", {write("tank.yaml", kTank), "--duration", "0.1s", "--set", motor});
  EXPECT_NE(awake["left_out"].dump().find("the motor of joint 'winch' keeps the scene awake"), std::string::npos);
}

}  // namespace
}  // namespace ballast::testing
