// Parts that a scene can do without: what is left out is in the record's table, leaves nothing behind, and changes no
// bit.
#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using nlohmann::json;

struct Part {
  const char* what;  // in the table
  const char* with;  // override that asks for it
  const char* without;
  const char* output;  // file that only a run with it has; empty: none
};
void PrintTo(const Part& part, std::ostream* out) { *out << part.what; }

struct LeftOutPart : ::testing::TestWithParam<Part> {
  Scratch scratch;
  void SetUp() override { setenv("LCM_DEFAULT_URL", "memq://", 1); }  // messages stay in the process
  json run(const char* folder, const char* set) const {
    fs::create_directories(scratch.path / folder);
    Command command(scratch.path / folder, {scene("stacked_blocks"), "--spacing", "6cm", "--duration", "0.2s", "--set",
                                            "expect=[]", "--set", set});
    EXPECT_EQ(command.wait(), 0) << command.text();
    return command.record();
  }
  static bool lists(const json& record, const std::string& what) {
    for (const json& row : record["left_out"])
      if (row["what"] == what) return true;
    return false;
  }
};

TEST_P(LeftOutPart, IsInTheTableAndChangesNoBit) {
  const Part& part = GetParam();
  const json with = run("with", part.with), without = run("without", part.without);
  EXPECT_TRUE(lists(without, part.what)) << without["left_out"];
  EXPECT_FALSE(lists(with, part.what)) << with["left_out"];
  EXPECT_EQ(with["state_hash"], without["state_hash"]);
  EXPECT_EQ(with["ledger"], without["ledger"]);
  if (*part.output == 0) return;
  EXPECT_TRUE(fs::exists(scratch.path / "with/out" / part.output));
  EXPECT_FALSE(fs::exists(scratch.path / "without/out" / part.output));
}

std::vector<Part> parts() {
  std::vector<Part> all = {{"ParaView files", "output.vtk=true", "output.vtk=false", "vtk"},
                           {"checkpoints", "output.checkpoint.every=0.05", "output.checkpoint.every=0", "checkpoints"},
                           {"probes.csv", "probes=[{name: level, level_at: [0.1, 0.3]}]", "probes=[]", "probes.csv"}};
  all.push_back({"contact sets", "coupling.contact_sets=always", "coupling.contact_sets=never", ""});
  if (fs::exists(BALLAST_BIN_DIR "/ballast_monitor"))  // a build with LCM
    all.push_back({"messages over LCM", "output.lcm=true", "output.lcm=false", ""});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Parts, LeftOutPart, ::testing::ValuesIn(parts()));

}  // namespace
}  // namespace ballast::testing
