// The record: what is measured is merged, what is not measured stays null.
#include "launch/record.h"

#include <gtest/gtest.h>

namespace ballast::launch {
namespace {

using nlohmann::json;

json fluid_report(std::array<double, 3> given, double scale) {
  return {{"ledger", {{"momentum_to_bodies_N_s", given}, {"momentum_scale", scale}}}};
}
json rigid_report(std::array<double, 3> received) { return {{"ledger", {{"momentum_received_N_s", received}}}}; }

TEST(MomentumImbalance, IsTheNormOfTheDifferenceOverTheScale) {
  // |(3, 4, 0)| / 10
  EXPECT_DOUBLE_EQ(*momentum_imbalance(fluid_report({4, 4, 1}, 10), rigid_report({1, 0, 1})), 0.5);
  EXPECT_DOUBLE_EQ(*momentum_imbalance(fluid_report({4, 4, 1}, 10), rigid_report({4, 4, 1})), 0);
}

TEST(MomentumImbalance, IsUnknownWhenOneSideIsSilentOrThereIsNoScale) {
  EXPECT_FALSE(momentum_imbalance(json::object(), rigid_report({1, 0, 1})));
  EXPECT_FALSE(momentum_imbalance(fluid_report({4, 4, 1}, 10), json::object()));
  EXPECT_FALSE(momentum_imbalance(fluid_report({4, 4, 1}, 0), rigid_report({1, 0, 1})));
}

struct Record : ::testing::Test {
  std::unique_ptr<Prepared> prepared;
  std::optional<Collector> collector;
  Outcome outcome;

  void SetUp() override {
    auto scene = read_scene_text(
        "ballast: 1\nworld: { duration: 1 s, spacing: 0.1 }\n"
        "models: [ { name: ball, shape: { sphere: { radius: 0.1 } }, density: 500 } ]\n",
        "drop.yaml");
    ASSERT_TRUE(scene) << scene.error().text();
    auto bodies = make_bodies(*scene);
    ASSERT_TRUE(bodies);
    prepared = std::make_unique<Prepared>(Prepared{std::move(*scene), std::move(*bodies), false, true, {}});
    prepared->left_out.push_back({"fluid process", "no fluid in this scene", "a process", "none"});
    auto made = Collector::make(prepared->scene, false, true, ::testing::TempDir());
    ASSERT_TRUE(made);
    collector.emplace(std::move(*made));
    outcome.rigid = {{"state_hash", "00ff"}, {"rss_bytes", 5000000}, {"warnings", {"slow"}}};
  }
};

TEST_F(Record, HasEveryKeyThatScriptsRelyOn) {
  const json record = make_record(*prepared, outcome, *collector, {}, 2);
  for (const char* key : {"scene",
                          "scene_hash",
                          "version",
                          "machine",
                          "threads",
                          "engine",
                          "scheme",
                          "exit",
                          "simulated_s",
                          "wall_s",
                          "real_time_factor",
                          "steps",
                          "particle_steps_per_s",
                          "rss_bytes",
                          "particles",
                          "bodies",
                          "state_hash",
                          "error",
                          "ledger",
                          "stages",
                          "exchange_s",
                          "step_limits",
                          "expect",
                          "left_out",
                          "warnings",
                          "interrupted"}) {
    EXPECT_TRUE(record.contains(key)) << key;
  }
  EXPECT_EQ(record["scene"], "drop");
  EXPECT_EQ(record["state_hash"], "00ff");
  EXPECT_EQ(record["left_out"][0]["what"], "fluid process");
  EXPECT_EQ(record["warnings"], json({"slow"}));
}

TEST_F(Record, OfOneProcessHasItsOneThread) {
  EXPECT_EQ(make_record(*prepared, outcome, *collector, {}, 0)["threads"], 1);
  prepared->fluid = true;  // which died before it could say how many "all cores" are
  EXPECT_TRUE(make_record(*prepared, outcome, *collector, {}, 0)["threads"].is_null());
  EXPECT_EQ(make_record(*prepared, outcome, *collector, {}, 3)["threads"], 3);
  outcome.fluid = {{"threads", 2}};
  EXPECT_EQ(make_record(*prepared, outcome, *collector, {}, 0)["threads"], 2);
}

TEST_F(Record, OfAStoppedRunNamesTheSignalAndJudgesNothing) {
  outcome.exit = kProcessFailed;
  outcome.interrupted = true;
  outcome.stopped_by = "SIGHUP";
  Verdict verdict{.name = "ball.z last", .value = 0.25, .pass = true};
  verdict.not_judged = "the run was stopped by SIGHUP";
  const json record = make_record(*prepared, outcome, *collector, {verdict}, 2);
  EXPECT_EQ(record["stopped_by"], "SIGHUP");
  EXPECT_TRUE(record["expect"][0]["pass"].is_null());
  EXPECT_EQ(record["expect"][0]["not_judged"], verdict.not_judged);
  const std::vector<std::string> lines = summary_lines(record, "out/drop");
  EXPECT_TRUE(lines[0].ends_with("exit 5 (stopped by SIGHUP)")) << lines[0];
  EXPECT_NE(lines[3].find("expectations not judged: the run was stopped by SIGHUP"), std::string::npos) << lines[3];
  EXPECT_EQ(lines[3].find("met"), std::string::npos) << lines[3];
}

TEST_F(Record, InventsNoNumbers) {
  const json record = make_record(*prepared, outcome, *collector, {}, 2);
  EXPECT_TRUE(record["particle_steps_per_s"].is_null());
  EXPECT_TRUE(record["rss_bytes"]["fluid"].is_null());
  EXPECT_TRUE(record["ledger"]["imbalance_relative"].is_null());
  EXPECT_TRUE(record["real_time_factor"].is_null());
}

TEST_F(Record, SaysWhatOfTheFluidsMemoryIsArrays) {
  prepared->fluid = true;
  outcome.fluid = {{"rss_bytes", 36000000}, {"array_bytes", 18000000}, {"particles", {{"fluid", 10000}}}};
  const json record = make_record(*prepared, outcome, *collector, {}, 2);
  EXPECT_EQ(record["array_bytes"], 18000000);
  std::string all;
  for (const std::string& line : summary_lines(record, "out/drop")) all += line + "\n";
  EXPECT_NE(all.find("memory: fluid 36 MB (18.0 MB of arrays, 1.8 kB a particle), rigid 5 MB"), std::string::npos)
      << all;
}

TEST_F(Record, SaysHowManyMessagesWereSentOnlyIfAnyWereAskedFor) {
  EXPECT_FALSE(make_record(*prepared, outcome, *collector, {}, 2).contains("lcm"));
  outcome.lcm = {{"url", "udpm://"}, {"sent", 5}, {"dropped", 2}, {"failed", 0}};
  const json record = make_record(*prepared, outcome, *collector, {}, 2);
  EXPECT_EQ(record["lcm"], outcome.lcm);
  EXPECT_EQ(record["warnings"], json({"slow"}));
}

TEST_F(Record, WarnsOfMessagesThatCouldNotBeSent) {
  outcome.lcm = {{"url", "udpm://x"}, {"sent", 5}, {"dropped", 0}, {"failed", 3}};
  const json record = make_record(*prepared, outcome, *collector, {}, 2);
  EXPECT_NE(record["warnings"].dump().find("3 messages over LCM could not be sent to udpm://x"), std::string::npos)
      << record["warnings"];
}

TEST_F(Record, HashDependsOnBothProcesses) {
  outcome.fluid = {{"state_hash", "01"}};
  const json both = make_record(*prepared, outcome, *collector, {}, 2)["state_hash"];
  outcome.fluid = {{"state_hash", "02"}};
  const json other = make_record(*prepared, outcome, *collector, {}, 2)["state_hash"];
  EXPECT_NE(both, other);
  EXPECT_EQ(both.get<std::string>().size(), 16u);
}

TEST(FillLines, SayVolumeAndMassAskedAndGotAndWhatBodiesTook) {
  const json fluid = {{"fills",
                       {{{"fluid", "water"},
                         {"volume_asked_m3", 0.5},
                         {"volume_got_m3", 0.375},
                         {"mass_asked_kg", 500},
                         {"mass_kg", 375},
                         {"particles", 1200}}}}};
  EXPECT_EQ(fill_lines(fluid), std::vector<std::string>{"fluid water: asked 0.5 m^3, 500 kg; got 0.375 m^3, 375 kg in "
                                                        "1200 particles; 0.125 m^3 taken by bodies"});
  EXPECT_TRUE(fill_lines(json::object()).empty());
}

TEST_F(Record, EndsInFiveLinesWithExpectationsBesideRunTime) {
  outcome.exit = kExpectationMissed;
  Verdict verdict;
  verdict.name = "ball.z last";
  verdict.value = 0.25;
  const json record = make_record(*prepared, outcome, *collector, {verdict}, 2);
  const std::vector<std::string> lines = summary_lines(record, "out/drop");
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_NE(lines[0].find("exit 3"), std::string::npos);
  EXPECT_NE(lines[3].find("expectations 0 of 1 met: ball.z last 0.25"), std::string::npos) << lines[3];
  EXPECT_NE(lines[4].find("out/drop"), std::string::npos);
}

}  // namespace
}  // namespace ballast::launch
