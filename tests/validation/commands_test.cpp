// Commands that act, replayed from a record: formulas for a body in free fall, reasons of those refused, the same bits
// with other threads, with a checkpoint in between, and with one process or two.
#include <sstream>

#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using nlohmann::json;
using Words = std::vector<std::string>;

constexpr const char* kFall = R"(ballast: 1
world: { duration: 0.5 s }
models:
  - { name: ball, shape: { sphere: { radius: 0.1 } }, mass: 2 kg, pose: [0, 0, 10] }
  - { name: block, shape: { box: [1, 1, 1] }, mass: 5 kg, pose: [20, 0, 0.5] }
  - { name: floor, static: true, shape: { plane: { normal: [0, 0, 1] } } }
coupling: { rigid_step: 1 ms }
)";

struct Commands : ::testing::Test {
  Scratch scratch;
  fs::path replay = scratch.path / "replay.json";

  void write(const json& commands) const { std::ofstream(replay) << json{{"commands", commands}}; }
  Words replayed(Words words) const {
    words.insert(words.end(), {"--replay", replay.string()});
    return words;
  }
  std::string fall() const {
    std::ofstream(scratch.path / "fall.yaml") << kFall;
    return (scratch.path / "fall.yaml").string();
  }
};

json wrench(const char* body, json force, double duration) {
  return {
      {"action", "wrench"}, {"body", body}, {"force_N", force}, {"torque_N_m", {0, 0, 0}}, {"duration_s", duration}};
}
json pose(const char* body, json position) {
  return {{"action", "pose"}, {"body", body}, {"position_m", position}, {"orientation_wxyz", {1, 0, 0, 0}}};
}
json gravity(double z) { return {{"action", "gravity"}, {"gravity_m_s2", {0, 0, z}}}; }

TEST_F(Commands, MoveABodyInFreeFallAsTheFormulasSay) {
  // 0.1 s of fall, then none; 0.1 s of 4 N on 2 kg from 0.2 s on; put to x = 5 m at 0.4 s.
  write({at(100, gravity(0)), at(200, wrench("ball", {4, 0, 0}, 0.1)), at(400, pose("ball", {5, 0, 8}))});
  Command run(scratch.path, replayed({fall()}));
  ASSERT_EQ(run.wait(), 0) << run.text();
  const auto row = run.last_row("bodies.csv");
  EXPECT_NEAR(row.at("ball.vz"), -9.81 * 0.1, 1e-9);
  EXPECT_NEAR(row.at("ball.vx"), 4.0 / 2 * 0.1, 1e-9);
  EXPECT_NEAR(row.at("ball.x"), 5 + 0.2 * 0.1, 1e-9);
  EXPECT_NEAR(row.at("ball.z"), 8 - 0.981 * 0.1, 1e-9);
  const json commands = run.record()["commands"];
  ASSERT_EQ(commands.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(commands[k]["step"], (std::array{100, 200, 400})[k]);
    EXPECT_FALSE(commands[k].contains("refused")) << commands[k];
  }
}

TEST_F(Commands, ThatCannotBeAreRefusedAndTheRunGoesOn) {
  write({at(100, pose("ball", {20, 0, 1.05})), at(100, pose("ball", {20, 0, 1.2})), at(150, pose("ball", {0, 0, 0.05})),
         at(150, wrench("floor", {1, 0, 0}, 1)), at(9999, gravity(0))});
  Command run(scratch.path, replayed({fall()}));
  ASSERT_EQ(run.wait(), 0) << run.text();
  const json commands = run.record()["commands"], warnings = run.record()["warnings"];
  ASSERT_EQ(commands.size(), 5u);
  std::map<std::string, std::string> why;
  for (const json& c : commands) why[c.dump()] = c.value("refused", "");
  const auto refused = [&](const char* word) {
    int count = 0;
    for (const auto& [command, reason] : why) count += reason.find(word) != std::string::npos;
    return count;
  };
  EXPECT_EQ(refused("it would overlap 'block' by 0.0"), 1) << commands.dump(1);
  EXPECT_EQ(refused("it would overlap 'floor' by 0.0"), 1) << commands.dump(1);
  EXPECT_EQ(refused("'floor' is static"), 1) << commands.dump(1);
  EXPECT_EQ(refused("the run ended before it took effect"), 1) << commands.dump(1);
  EXPECT_EQ(warnings.size(), 3u) << warnings.dump(1);
  EXPECT_NE(run.text().find("was refused: it would overlap 'block'"), std::string::npos) << run.text();
}

TEST_F(Commands, GiveTheSameBitsWithOtherThreadsAndFromACheckpoint) {
  const Words blocks{scene("stacked_blocks"),  "--spacing", "5cm", "--duration", "0.35s", "--set",
                     "numerics.pressure=wcsph"};
  write({at(60, wrench("block_0_0_2", {5, 0, 10}, 0.2)), at(90, gravity(-5)),
         at(120, pose("block_2_2_2", {1.2, 0.3, 1})), at(130, pose("block_1_1_2", {0.3, 0.3, 0.3})),
         at(290, gravity(-9.81))});
  for (const char* folder : {"a", "b"}) fs::create_directories(scratch.path / folder);
  Words words = replayed(blocks);
  words.insert(words.end(), {"--threads", "1", "--checkpoint", "0.1s"});
  Command first(scratch.path / "a", words);
  first.wait();
  const json record = first.record();
  ASSERT_EQ(record["commands"].size(), 5u) << first.text();
  int refused = 0;
  for (const json& c : record["commands"])
    if (c.contains("refused")) {
      ++refused;
      EXPECT_NE(c["refused"].get<std::string>().find("particles"), std::string::npos) << c;
    }
  EXPECT_EQ(refused, 1) << "the body that would be put into the water: " << record["commands"].dump(1);

  Command quiet(scratch.path, blocks);
  quiet.wait();
  EXPECT_NE(quiet.record()["state_hash"], record["state_hash"]) << "the commands did nothing";
  Command again(scratch.path, replayed(blocks));
  again.wait();
  EXPECT_EQ(again.record()["state_hash"], record["state_hash"]);
  Command resumed(scratch.path / "b", {"--resume", (scratch.path / "a/out").string(), "--replay",
                                       (scratch.path / "a/out/record.json").string()});
  resumed.wait();
  EXPECT_GT(resumed.record()["resumed"]["after_step"], 130) << resumed.text();
  EXPECT_EQ(resumed.record()["state_hash"], record["state_hash"]);
  EXPECT_EQ(resumed.record()["commands"].size(), 5u) << resumed.record()["commands"].dump(1);
}

struct CommandsTakenBack : Commands, ::testing::WithParamInterface<const char*> {};

/// Steps of eight times the sound's limit: some are done again, with their commands, which must count once; by the
/// iterated scheme many more.
TEST_P(CommandsTakenBack, CountOnce) {
  const Words blocks{scene("stacked_blocks"),
                     "--spacing",
                     "5cm",
                     "--duration",
                     "0.4s",
                     "--set",
                     "numerics.courant=8",
                     "--set",
                     "numerics.pressure=wcsph",
                     "--set",
                     "numerics.energy_bound=1",
                     "--scheme",
                     GetParam()};
  json pushes = json::array();
  for (int step = 5; step < 150; ++step)
    pushes.push_back(at(step, wrench("block_0_0_2", {0.5 * (step % 3), 0, 1}, 3e-3)));
  write(pushes);
  for (const char* folder : {"a", "b"}) fs::create_directories(scratch.path / folder);
  Words words = replayed(blocks);
  words.insert(words.end(), {"--checkpoint", "50ms", "--threads", "1"});
  Command first(scratch.path / "a", words);
  ASSERT_NE(first.wait(), 5) << first.text();
  ASSERT_GT(first.record()["step_limits"].value("retry", 0), 0) << "this test has no power";
  ASSERT_EQ(first.record()["commands"].size(), pushes.size());
  for (std::size_t k = 0; k < pushes.size(); ++k) {
    EXPECT_EQ(first.record()["commands"][k]["step"], pushes[k]["step"]);
    EXPECT_FALSE(first.record()["commands"][k].contains("refused"));
  }
  Command resumed(scratch.path / "b", {"--resume", (scratch.path / "a/out").string(), "--replay", replay.string()});
  resumed.wait();
  EXPECT_EQ(resumed.record()["state_hash"], first.record()["state_hash"]) << resumed.text();
}

INSTANTIATE_TEST_SUITE_P(Schemes, CommandsTakenBack, ::testing::Values("interlinked", "iterated"),
                         [](const auto& each) { return std::string(each.param); });

/// Half the gravity, half the weight on the tank; 5 %: the sudden change rings in the column.
TEST_F(Commands, ChangeTheWeightOfWater) {
  write(json::array({at(100, gravity(-4.905))}));
  Command run(scratch.path, replayed({scene("hydrostatic"), "--duration", "3s"}));
  EXPECT_EQ(run.wait(), 3) << "the scene expects the whole weight: " << run.text();
  EXPECT_EQ(run.record()["commands"][0]["step"], 100) << run.record()["commands"];
  std::istringstream rows(text_of(scratch.path / "out/probes.csv"));
  std::string head, line;
  std::getline(rows, head);
  ASSERT_EQ(head.substr(0, 37), "t,pressure_error,level,walls.fx,walls") << head;
  double sum = 0, number = 0;
  while (std::getline(rows, line)) {
    std::vector<double> values;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
    if (values.at(0) > 1) sum += values.at(5), ++number;
  }
  ASSERT_GT(number, 50);
  EXPECT_NEAR(sum / number, -1000 * 4.905, 0.05 * 1000 * 4.905);
}

}  // namespace
}  // namespace ballast::testing
