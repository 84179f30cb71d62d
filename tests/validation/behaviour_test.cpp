// What every run keeps, seen from outside: only the processes needed, the same bits whatever the threads, no momentum
// made or lost at the interface, broken scenes refused with their place, nothing left behind by a dead process.
#include <cmath>
#include <numbers>
#include <regex>

#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using Clock = std::chrono::steady_clock;
using Names = std::set<std::string>;

struct Behaviour : ::testing::Test {
  Scratch scratch;
};

TEST_F(Behaviour, ThePendulumStartsNoFluidProcessAndSaysSo) {
  Command run(scratch.path, {scene("pendulum")});
  EXPECT_EQ(run.wait(), 0) << run.text();
  EXPECT_EQ(run.seen(), Names{"rigid_client"});
  EXPECT_NE(run.text().find("no fluid in this scene: no fluid process"), std::string::npos) << run.text();
  EXPECT_TRUE(run.record()["rss_bytes"]["fluid"].is_null());
}

TEST_F(Behaviour, ATankWithoutMovingBodiesStartsNoRigidProcessAndSaysSo) {
  Command run(scratch.path, {scene("dam_break_empty"), "--duration", "0.02s"});
  EXPECT_EQ(run.wait(), 0) << run.text();
  EXPECT_EQ(run.seen(), Names{"fluid_server"});
  EXPECT_NE(run.text().find("every model is static: no rigid process"), std::string::npos) << run.text();
  EXPECT_TRUE(run.record()["rss_bytes"]["rigid"].is_null());
}

/// 0.3 s: the front has reached the blocks, so that particles and bodies both hang on the exchange.
TEST_F(Behaviour, TheStateHashHangsNeitherOnTheNumberOfThreadsNorOnTheRun) {
  std::map<std::string, nlohmann::json> hashes;
  for (const std::string pressure : {"wcsph", "implicit"})
    for (const char* threads : {"1", "2", "3", "2"}) {
      Command run(scratch.path, {scene("stacked_blocks"), "--duration", "0.3s", "--threads", threads, "--set",
                                 "numerics.pressure=" + pressure});
      EXPECT_EQ(run.wait(), 3) << run.text();  // too short for blocks to have moved as far as the scene expects
      EXPECT_EQ(run.seen(), (Names{"fluid_server", "rigid_client"}));
      const nlohmann::json record = run.record();
      ASSERT_TRUE(record["state_hash"].is_string());
      const auto first = hashes.try_emplace(pressure, record["state_hash"]).first;
      EXPECT_EQ(record["state_hash"], first->second) << pressure << ", " << threads << " threads";
      EXPECT_GT(record["ledger"]["momentum_to_bodies_N_s"][0], 0.0) << "the water has not reached the blocks";
      EXPECT_LE(record["ledger"]["imbalance_relative"], 1e-12);
    }
  Command other(scratch.path, {scene("stacked_blocks"), "--duration", "0.29s", "--threads", "2"});
  other.wait();
  EXPECT_NE(other.record()["state_hash"], hashes["implicit"]);
}

TEST_F(Behaviour, NoSceneMakesOrLosesMomentumAtTheInterface) {
  int coupled = 0;
  for (const auto& entry : fs::directory_iterator(BALLAST_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().string());
    Command run(scratch.path,
                {entry.path().string(), "--duration", "5ms", "--no-expect", "--set", "numerics.relax=false"});
    const int code = run.wait();
    EXPECT_TRUE(code == 0 || code == 3) << code << "\n" << run.text();
    EXPECT_EQ(run.left_behind(), std::vector<std::string>{});
    if (run.seen().size() < 2) continue;
    ++coupled;
    const nlohmann::json record = run.record();
    ASSERT_TRUE(record["ledger"]["imbalance_relative"].is_number());
    EXPECT_LE(record["ledger"]["imbalance_relative"], 1e-12);
  }
  EXPECT_GE(coupled, 5);
}

/// A free body that touches nothing has exactly what fluid and gravity gave it: m v = J + m g t.
TEST_F(Behaviour, ABodyHasTheMomentumThatTheFluidGaveIt) {
  Command run(scratch.path, {scene("added_mass_2d"), "--duration", "10ms", "--no-expect"});
  run.wait();
  const double mass = 500 * std::numbers::pi * 0.1 * 0.1, gravity = -9.81;
  const auto row = run.last_row("bodies.csv");
  const nlohmann::json given = run.record()["ledger"]["momentum_to_bodies_N_s"];
  ASSERT_EQ(given.size(), 3u) << run.text();
  ASSERT_NEAR(row.at("t"), 0.01, 1e-12);
  EXPECT_GT(given[2], 0.0);
  // sums of some hundred steps in double
  EXPECT_NEAR(given[2].get<double>(), mass * (row.at("body.vz") - gravity * row.at("t")), 1e-9);
  EXPECT_NEAR(given[0].get<double>(), mass * row.at("body.vx"), 1e-9);
}

struct Broken {
  const char* name;
  const char* text;  // the mark ^ is taken out; the message must point to where it stood
  const char* word;  // and have this
};
void PrintTo(const Broken& broken, std::ostream* out) { *out << broken.name; }

struct BrokenScene : Behaviour, ::testing::WithParamInterface<Broken> {};

TEST_P(BrokenScene, IsRefusedWithFileLineAndColumn) {
  std::string text = GetParam().text;
  const std::size_t mark = text.find('^');
  ASSERT_NE(mark, std::string::npos);
  text.erase(mark, 1);
  const std::string before = text.substr(0, mark);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t column = mark - (before.find_last_of('\n') + 1) + 1;
  std::ofstream(scratch.path / "broken.yaml") << text;
  Command run(scratch.path, {(scratch.path / "broken.yaml").string()});
  EXPECT_EQ(run.wait(), 2);
  EXPECT_EQ(run.seen(), Names{});
  const std::string place = "broken.yaml:" + std::to_string(line) + ":" + std::to_string(column) + ":";
  EXPECT_NE(run.text().find(place), std::string::npos) << "not at " << place << "\n" << run.text();
  EXPECT_NE(run.text().find(GetParam().word), std::string::npos) << run.text();
  EXPECT_FALSE(fs::exists(scratch.path / "out/record.json"));
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, BrokenScene,
    ::testing::Values(Broken{"MisspeltKey", "ballast: 1\nworld: { ^durration: 1 s, spacing: 0.1 }\n", "duration"},
                      Broken{"WrongDimension", "ballast: 1\nworld: { duration: ^1 m, spacing: 0.1 }\n", "duration"},
                      Broken{"NegativeLength", "ballast: 1\nworld: { duration: 1 s, spacing: ^-2 cm }\n", "spacing"},
                      Broken{"UnknownUnit", "ballast: 1\nworld: { duration: 1 s, spacing: ^2 furlongs }\n", "furlongs"},
                      Broken{"UnknownModel",
                             "ballast: 1\nworld: { duration: 1 s, spacing: 0.1 }\nmodels:\n"
                             "  - { name: rod, shape: { box: [1, 1, 1] }, mass: 1 }\njoints:\n"
                             "  - { name: pin, type: ball, parent: world, child: ^road, anchor: [0, 0, 0] }\n",
                             "rod"},
                      Broken{"TwiceTheSameKey", "ballast: 1\nworld: { duration: 1 s, spacing: 0.1, ^spacing: 0.2 }\n",
                             "spacing"},
                      Broken{"NoYaml", "ballast: 1\nworld: { duration: 1 s, spacing: 0.1\nmodels^: [\n", ""}),
    [](const auto& each) { return std::string(each.param.name); });

TEST_F(Behaviour, ADivergedRunSaysWhenWhereAndWhyAndKeepsItsState) {
  Command run(scratch.path,
              {scene("added_mass_2d"), "--set", "coupling.scheme=staggered", "--set", "models.body.density=10"});
  EXPECT_EQ(run.wait(), 4) << run.text();
  for (const char* word : {"diverged at t =", "limit", "particles", "'body'", "is staggered", "post_mortem/"})
    EXPECT_NE(run.text().find(word), std::string::npos) << word << " is not in\n" << run.text();
  EXPECT_TRUE(fs::exists(scratch.path / "out/post_mortem/particles.pvd"));
  EXPECT_EQ(run.record()["exit"], 4);
  EXPECT_EQ(run.left_behind(), std::vector<std::string>{});
}

/// Steps beyond what the scheme bears feed the fluid with energy long before anything is not a number.
TEST_F(Behaviour, ARunThatGainsEnergyHasDiverged) {
  const std::vector<std::string> words{scene("report/tank_box"), "--set", "numerics.courant=3", "--duration", "1s"};
  Command run(scratch.path, words);
  EXPECT_EQ(run.wait(), 4) << run.text();
  for (const char* word : {"the fluid has gained", "numerics.energy_bound", "numerics.courant = 3",
                           "expectations not judged: the run diverged", "post_mortem/"})
    EXPECT_NE(run.text().find(word), std::string::npos) << word << " is not in\n" << run.text();
  EXPECT_GT(run.record()["error"].value("energy_gain", 0.0), 0.1);
  EXPECT_TRUE(run.record()["expect"][0]["pass"].is_null());
  auto sound = words;
  sound[2] = "numerics.courant=0.5";
  Command fine(scratch.path, sound);
  EXPECT_EQ(fine.wait(), 0) << fine.text();
  EXPECT_LT(fine.record()["error"].value("energy_gain", 1.0), 0.01);
}

/// Many times the limit: the end names the checkpoint before the trouble, from which a resumed run gets as far.
TEST_F(Behaviour, ADivergedRunNamesItsLastCheckpoint) {
  Command run(scratch.path,
              {scene("stacked_blocks"), "--spacing", "5cm", "--duration", "0.4s", "--set", "numerics.pressure=wcsph",
               "--set", "numerics.courant=16", "--set", "numerics.energy_bound=0.02", "--checkpoint", "20ms"});
  EXPECT_EQ(run.wait(), 4) << run.text();
  for (const char* word : {"numerics.courant = 16", "post_mortem/", "last whole checkpoint: step", "--resume"})
    EXPECT_NE(run.text().find(word), std::string::npos) << word << " is not in\n" << run.text();
  const auto record = run.record();
  ASSERT_TRUE(record.contains("last_checkpoint")) << record;
  // The end is that of the last good step, whose checkpoint may be the last one; the step that diverged comes later.
  EXPECT_LE(record["last_checkpoint"]["time_s"], record["simulated_s"]);
  std::smatch diverged;
  const std::string text = run.text();
  ASSERT_TRUE(std::regex_search(text, diverged, std::regex(R"(diverged at t = [^(]*\(step (\d+),)"))) << text;
  EXPECT_LT(record["last_checkpoint"]["step"].get<int>(), std::stoi(diverged[1]));
  EXPECT_GT(record["last_checkpoint"]["time_s"], record["simulated_s"].get<double>() - 0.05);
  fs::create_directories(scratch.path / "again");
  Command again(scratch.path / "again", {"--resume", (scratch.path / "out").string()});
  EXPECT_EQ(again.wait(), 4) << again.text();
  EXPECT_EQ(again.record()["state_hash"], record["state_hash"]);
}

/// Steps that are much too long are done again, shorter, also where no rigid process has kept the states before them.
TEST_F(Behaviour, StepsAreTakenBackWithoutARigidProcessToo) {
  Command run(scratch.path, {scene("hydrostatic"), "--set", "numerics.courant=8", "--duration", "0.2s", "--no-expect"});
  EXPECT_NE(run.wait(), 5) << run.text();
  EXPECT_GT(run.record()["step_limits"].value("retry", 0), 0) << run.text();
}

struct DeadPartner : Behaviour, ::testing::WithParamInterface<std::tuple<const char*, int>> {};

TEST_P(DeadPartner, EndsTheRunWithinHalfASecondAndLeavesNothing) {
  Command run(scratch.path, {scene("stacked_blocks")});
  const auto [name, signal] = GetParam();
  const std::string victim = name;
  const auto start = Clock::now();
  while (run.children().size() < 2 && Clock::now() - start < std::chrono::seconds(20))
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_EQ(run.children().size(), 2u) << run.text();
  // into the steps: the start takes about half a second
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  const auto children = run.children();
  ASSERT_EQ(children.size(), 2u) << run.text();
  kill(children.at(victim), signal);
  const auto killed = Clock::now();
  EXPECT_EQ(run.wait(), 5) << run.text();
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - killed).count(), 0.5);
  EXPECT_NE(run.text().find(victim == "fluid_server" ? "fluid process" : "rigid process"), std::string::npos);
  EXPECT_NE(run.text().find("signal " + std::to_string(signal)), std::string::npos) << run.text();
  for (const auto& [process, pid] : children) EXPECT_NE(kill(pid, 0), 0) << process << " still runs";
  EXPECT_EQ(run.left_behind(), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Processes, DeadPartner,
                         ::testing::Combine(::testing::Values("fluid_server", "rigid_client"),
                                            ::testing::Values(SIGKILL, SIGTERM, SIGINT)),
                         [](const auto& each) {
                           return std::get<0>(each.param) + ("_" + std::to_string(std::get<1>(each.param)));
                         });

}  // namespace
}  // namespace ballast::testing
