// A run that goes on from a checkpoint ends as the unbroken one: state, rows, sums, verdicts; with every solver, engine
// and scheme, with other threads, with one process or two. Wrong scenes and damaged checkpoints are refused.
#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using namespace nlohmann::literals;
using Words = std::vector<std::string>;

Words joined(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// What must be the same, wall times left out.
nlohmann::json results(const nlohmann::json& record) {
  nlohmann::json out;
  for (const char* key : {"state_hash", "exit", "steps", "simulated_s", "particles", "error", "ledger", "step_limits",
                          "expect", "warnings", "engine", "scheme"})
    out[key] = record.contains(key) ? record[key] : nlohmann::json();
  for (const char* side : {"rigid_process", "fluid_process"})
    for (const char* key : {"jitter_m_s2", "contact_sets", "barrier", "relaxation", "pressure_solve"})
      if (record.contains(side) && record[side].contains(key)) out[side][key] = record[side][key];
  if (const auto seconds = "/fluid_process/pressure_solve/seconds"_json_pointer; out.contains(seconds))
    out[seconds] = nullptr;  // wall time
  return out;
}

struct Kind {
  const char* name;
  Words arguments;
  const char* every;
};
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

struct Resumed : ::testing::TestWithParam<Kind> {
  Scratch scratch;
};

TEST_P(Resumed, RunsEndAsTheUnbrokenOne) {
  const Kind& kind = GetParam();
  const fs::path a = scratch.path / "a", b = scratch.path / "b", c = scratch.path / "c";
  for (const fs::path& folder : {a, b, c}) fs::create_directories(folder);
  Command unbroken(a, kind.arguments);
  const int code = unbroken.wait();
  ASSERT_TRUE(code == 0 || code == 3) << unbroken.text();
  EXPECT_FALSE(fs::exists(a / "out/checkpoints")) << "nobody asked for them";
  Command first(b, joined(kind.arguments, {"--checkpoint", kind.every}));
  EXPECT_EQ(first.wait(), code) << first.text();
  EXPECT_EQ(results(first.record()), results(unbroken.record())) << "checkpoints change the result";
  ASSERT_GE(first.record().value("checkpoints", 0), 1) << first.text();
  Command resumed(c, {"--resume", (b / "out").string(), "--threads", "3"});
  EXPECT_EQ(resumed.wait(), code) << resumed.text();
  EXPECT_GT(resumed.record()["resumed"]["after_step"], 0);
  EXPECT_EQ(results(resumed.record()), results(unbroken.record()));
  for (const char* file : {"bodies.csv", "probes.csv"})
    EXPECT_EQ(text_of(c / "out" / file), text_of(a / "out" / file)) << file;
}

Words blocks(const std::string& pressure) {
  return {scene("stacked_blocks"), "--spacing", "5cm", "--duration", "0.4s", "--set", "numerics.pressure=" + pressure};
}
const Words kBox{scene("floating_box"), "--spacing", "10cm", "--duration", "0.5s", "--set", "expect=[]"};

INSTANTIATE_TEST_SUITE_P(
    Kinds, Resumed,
    ::testing::Values(Kind{"Explicit", blocks("wcsph"), "0.15s"}, Kind{"Implicit", blocks("implicit"), "0.15s"},
                      Kind{"Staggered", joined(kBox, {"--scheme", "staggered"}), "0.2s"},
                      Kind{"Iterated", joined(blocks("wcsph"), {"--scheme", "iterated"}), "0.15s"},
                      Kind{"IteratedImplicit", joined(blocks("implicit"), {"--scheme", "iterated"}), "0.15s"},
                      Kind{"FreeBody", {scene("added_mass_2d"), "--engine", "free_body", "--duration", "20ms"}, "8ms"},
                      Kind{"Substeps", joined(blocks("wcsph"), {"--set", "coupling.substeps=3"}), "0.15s"},
                      Kind{"RigidAlone", {scene("pendulum"), "--duration", "1s", "--set", "expect=[]"}, "0.4s"},
                      Kind{"FluidAlone", {scene("dam_break_empty"), "--duration", "0.2s"}, "0.08s"}),
    [](const auto& each) { return std::string(each.param.name); });

struct Longer : Resumed {};

/// The duration decides the end alone: what a shorter run has left goes on to be the longer one.
TEST_P(Longer, RunsEndAsThoseThatWereToLastThatLong) {
  const Kind& kind = GetParam();
  const fs::path a = scratch.path / "a", b = scratch.path / "b";
  for (const fs::path& folder : {a, b}) fs::create_directories(folder);
  Command unbroken(a, joined(kind.arguments, {"--duration", "0.3s"}));
  const int code = unbroken.wait();
  ASSERT_TRUE(code == 0 || code == 3) << unbroken.text();
  Command shorter(b, joined(kind.arguments, {"--duration", "0.2s", "--checkpoint", kind.every}));
  shorter.wait();
  fs::rename(b / "out", b / "shorter");
  Command resumed(b, {"--resume", (b / "shorter").string(), "--duration", "0.3s"});
  EXPECT_EQ(resumed.wait(), code) << resumed.text();
  EXPECT_GT(resumed.record()["resumed"]["time_s"], 0.15);
  EXPECT_EQ(results(resumed.record()), results(unbroken.record()));
  for (const char* file : {"bodies.csv", "probes.csv"})
    EXPECT_EQ(text_of(b / "out" / file), text_of(a / "out" / file)) << file;
  Command past(b, {"--resume", (b / "shorter").string(), "--duration", "0.1s"});
  EXPECT_EQ(past.wait(), 2) << past.text();
  EXPECT_NE(past.text().find("let the run last longer"), std::string::npos) << past.text();
}

// Checkpoints so often that one would fall on the step that the end of the shorter run cuts.
INSTANTIATE_TEST_SUITE_P(
    Kinds, Longer,
    ::testing::Values(
        Kind{"Explicit", {scene("floating_box"), "--no-expect"}, "0.1ms"},
        Kind{"Implicit", {scene("floating_box"), "--no-expect", "--set", "numerics.pressure=implicit"}, "0.1ms"},
        Kind{"RigidAlone", {scene("pendulum"), "--no-expect"}, "0.1ms"},
        Kind{"FluidAlone", {scene("dam_break_2d"), "--no-expect", "--spacing", "2cm"}, "0.1ms"}),
    [](const auto& each) { return std::string(each.param.name); });

struct Checkpoints : ::testing::Test {
  Scratch scratch;
  fs::path first = scratch.path / "first", second = scratch.path / "second";
  void SetUp() override {
    fs::create_directories(first);
    fs::create_directories(second);
  }
  Words pendulum(Words more) const {
    return joined({scene("pendulum"), "--duration", "0.5s", "--set", "expect=[]"}, more);
  }
  std::vector<fs::path> folders() const {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(first / "out/checkpoints")) out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
  }
};

TEST_F(Checkpoints, AreKeptAsManyAsAskedFor) {
  Command run(first, pendulum({"--checkpoint", "50ms", "--set", "output.checkpoint.keep=3"}));
  run.wait();
  EXPECT_EQ(run.record()["checkpoints"], 9) << "at 50 ms to 450 ms; none at the end, where nothing follows";
  EXPECT_EQ(folders().size(), 3u);
}

TEST_F(Checkpoints, OfAnotherSceneAreRefusedWithTheKeysThatDiffer) {
  Command run(first, pendulum({"--checkpoint", "50ms"}));
  run.wait();
  Command other(second, joined(pendulum({"--resume", (first / "out").string()}),
                               {"--set", "world.gravity=[0,0,-3]", "--set", "coupling.rigid_step=2ms"}));
  EXPECT_EQ(other.wait(), 2);
  for (const char* word : {"world/gravity", "coupling/rigid_step", "not that of the checkpoint"})
    EXPECT_NE(other.text().find(word), std::string::npos) << other.text();
  EXPECT_EQ(other.text().find("world/duration"), std::string::npos) << other.text();
  Command same(second, pendulum({"--resume", (first / "out").string(), "--set", "output.checkpoint.keep=9"}));
  EXPECT_TRUE(same.wait() == 0 || same.wait() == 3) << same.text();
}

/// What the scene leaves to the program is in the checkpoint as it was chosen.
TEST_F(Checkpoints, OfAFluidAreOfTheSameSceneGivenAgain) {
  Command run(first, joined(kBox, {"--checkpoint", "0.2s"}));
  ASSERT_EQ(run.wait(), 0) << run.text();
  const Words again = joined(kBox, {"--resume", (first / "out").string()});
  Command other(second, joined(again, {"--set", "models.box.density=400"}));
  EXPECT_EQ(other.wait(), 2);
  EXPECT_NE(other.text().find(": models/box/density differs"), std::string::npos) << other.text();
  Command same(second, again);
  EXPECT_EQ(same.wait(), 0) << same.text();
  EXPECT_EQ(same.record()["state_hash"], run.record()["state_hash"]);
}

/// Without weights the speed at which ODE parts bodies that overlap comes from the duration.
TEST_F(Checkpoints, OfWeightlessBodiesLastNoLonger) {
  Command run(first, pendulum({"--set", "world.gravity=[0,0,0]", "--checkpoint", "50ms"}));
  run.wait();
  Command longer(second, {"--resume", (first / "out").string(), "--duration", "1s"});
  EXPECT_EQ(longer.wait(), 2) << longer.text();
  EXPECT_NE(longer.text().find("was to last 0.5 s, not 1 s"), std::string::npos) << longer.text();
  Command same(second, {"--resume", (first / "out").string(), "--duration", "0.5s"});
  EXPECT_EQ(same.wait(), 0) << same.text();
}

TEST_F(Checkpoints, ThatAreDamagedAreNamedAndTheOneBeforeIsTaken) {
  Command run(first, pendulum({"--checkpoint", "50ms"}));
  run.wait();
  ASSERT_EQ(folders().size(), 2u);
  const fs::path part = folders()[1] / "rigid";
  fs::resize_file(part, fs::file_size(part) - 1);
  Command resumed(second, {"--resume", (first / "out").string()});
  const int code = resumed.wait();
  EXPECT_TRUE(code == 0 || code == 3) << resumed.text();
  EXPECT_NE(resumed.text().find(part.string() + ": its checksum is wrong"), std::string::npos) << resumed.text();
  EXPECT_EQ(resumed.record()["state_hash"], run.record()["state_hash"]);
  fs::remove(folders()[0] / "run");
  Command none(second, {"--resume", (first / "out").string()});
  EXPECT_EQ(none.wait(), 2);
  EXPECT_NE(none.text().find("no checkpoint to resume from"), std::string::npos) << none.text();
}

}  // namespace
}  // namespace ballast::testing
