// A process of a run is killed at any moment: the others end soon, say who it was, and nothing stays behind.
#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Spread evenly over [0, 1), and nowhere in step with anything: multiples of the golden ratio.
double moment(int i) { return i * 0.6180339887498949 - std::floor(i * 0.6180339887498949); }

/// A coupled run that would take minutes.
const std::vector<std::string> kLong = {scene("floating_box"), "--quiet", "--duration",          "1000s", "--set",
                                        "expect=[]",           "--set",   "numerics.relax=false"};

struct Times {
  const char* victim;
  int times;
};
void PrintTo(const Times& t, std::ostream* out) { *out << t.victim << " x " << t.times; }

struct Killed : ::testing::TestWithParam<Times> {
  Scratch scratch;
  /// s from the kill to the end of all others.
  double once(int i);
  void check(const Command& run, int code, const std::string& victim);
  void check_orphans(std::size_t there);
};

double Killed::once(int i) {
  const std::string victim = GetParam().victim;
  const bool whole = victim == "coordinator";
  if (whole) prctl(PR_SET_CHILD_SUBREAPER, 1);  // orphans become ours: what they end with can be read
  Command run(scratch.path, kLong);
  EXPECT_TRUE(whole || run.has_children(2)) << run.text();
  std::this_thread::sleep_for(milliseconds(static_cast<int>(1000 * moment(i))));
  const auto children = run.children();
  if (!whole && !children.contains(victim)) {
    ADD_FAILURE() << victim << " does not run\n" << run.text();
    return 0;
  }
  kill(whole ? run.pid() : children.at(victim), SIGKILL);
  const auto start = Clock::now();

  const int code = run.wait();
  while (!run.attached().empty() && seconds_since(start) < 10) std::this_thread::sleep_for(milliseconds(2));
  const double took = seconds_since(start);
  EXPECT_LT(took, 10) << "somebody still runs";
  check(run, code, victim);
  if (whole) check_orphans(children.size());
  return took;
}

/// The children of a killed coordinator say who died and end with code 5; those that had not begun yet, with 127.
void Killed::check_orphans(std::size_t there) {
  std::size_t told = 0;
  for (int status; waitpid(-1, &status, 0) > 0;) {
    EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 5 || WEXITSTATUS(status) == 127)) << status;
    told += WIFEXITED(status) && WEXITSTATUS(status) == 5;
  }
  EXPECT_GE(told, there);
  std::size_t said = 0;
  for (const char* log : {"out/fluid_server.log", "out/rigid_client.log"}) {
    std::ifstream file(scratch.path / log);
    const std::string text(std::istreambuf_iterator<char>(file), {});
    said += text.find("coordinator") != std::string::npos;
  }
  EXPECT_EQ(said, told) << "told of the coordinator's end, in their logs";
}

void Killed::check(const Command& run, int code, const std::string& victim) {
  EXPECT_EQ(run.left_behind(), std::vector<std::string>{});
  if (victim == "coordinator") {
    EXPECT_EQ(code, -SIGKILL);
    EXPECT_FALSE(fs::exists(scratch.path / "out/record.json"));
    EXPECT_FALSE(fs::exists(scratch.path / "out/bodies.csv")) << "rows of half a run under the name of whole ones";
    return;
  }
  EXPECT_EQ(code, 5) << run.text();
  const std::string name = victim == "fluid_server" ? "the fluid process" : "the rigid process";
  EXPECT_NE(run.text().find(name), std::string::npos) << run.text();
  EXPECT_NE(run.text().find("was killed by signal 9"), std::string::npos) << run.text();
  EXPECT_EQ(run.record().value("exit", -1), 5);
}

TEST_P(Killed, AtAnyMomentEndsTheOthersSoonAndLeavesNothing) {
  std::vector<double> took;
  for (int i = 0; i < GetParam().times && !HasFailure(); ++i) took.push_back(once(i));
  std::ranges::sort(took);
  ASSERT_FALSE(took.empty());
  // Promised is half a second; one in ten may fall to a machine that does something else.
  EXPECT_LT(took[took.size() * 9 / 10 - (took.size() < 10 ? 1 : 0)], 0.5);
  std::printf("%s killed %zu times: the others ended after %.3f s (median), %.3f s (longest)\n", GetParam().victim,
              took.size(), took[took.size() / 2], took.back());
}

constexpr Times kFew[] = {{"fluid_server", 4}, {"rigid_client", 4}, {"coordinator", 4}};
constexpr Times kHundred[] = {{"fluid_server", 100}, {"rigid_client", 100}, {"coordinator", 100}};
const auto name_of = [](const auto& each) { return std::string(each.param.victim); };
INSTANTIATE_TEST_SUITE_P(FewTimes, Killed, ::testing::ValuesIn(kFew), name_of);
INSTANTIATE_TEST_SUITE_P(HundredTimes, Killed, ::testing::ValuesIn(kHundred), name_of);

}  // namespace
}  // namespace ballast::testing
