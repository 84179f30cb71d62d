// The founding scene from beginning to end through the real command: two processes, nothing shortened, its own
// expectations as the check. Yardsticks of the same run: real time, the wall time itself, the bare record of a
// particle.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <vector>

#include "tests/bench/output.h"

namespace {

namespace fs = std::filesystem;
using namespace ballast;
using nlohmann::json;

constexpr const char* kScene = "stacked_blocks";
constexpr int kThreads = 2;

/// The run's record; discarded if there is none.
json record_of_run(const fs::path& folder) {
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  const std::string command =
      fmt::format("'{}' run '{}/scenes/{}.yaml' --quiet --threads {} --out '{}' >&2",
                  (programs / "ballast_coordinator").string(), BALLAST_SOURCE_DIR, kScene, kThreads, folder.string());
  if (std::system(command.c_str()) != 0) std::fprintf(stderr, "scenes_bench: the run failed\n");
  std::ifstream file(folder / "record.json");
  return json::parse(file, nullptr, false);
}

bool is_right(const json& r) {
  return r["exit"] == 0 && r["particles"]["lost"] == 0 && r["ledger"]["imbalance_relative"].is_number() &&
         r["ledger"]["imbalance_relative"] <= 1e-12;
}

}  // namespace

int main(int argc, char** argv) {
  bench::Options options;
  if (!options.parse(argc, argv, 1)) return kBadInput;
  const fs::path folder = fs::temp_directory_path() / fmt::format("ballast_scenes_bench_{}", getpid());
  std::vector<double> pace, wait, share;
  double bytes = 0;
  std::size_t particles = 0;
  bool good = true;
  for (int k = 0; k < options.repetitions; ++k) {
    const json r = record_of_run(folder);
    fs::remove_all(folder);
    if (!r.is_object()) return kProcessFailed;
    good = good && is_right(r);
    const double wall = r["wall_s"], steps = r["steps"], waited = r["exchange_s"];
    particles = r["particles"]["fluid"];
    pace.push_back(wall / r["simulated_s"].get<double>());
    wait.push_back(1e6 * waited / steps);
    share.push_back(waited / wall);
    bytes = (r["rss_bytes"]["fluid"].get<double>() + r["rss_bytes"]["rigid"].get<double>()) /
            static_cast<double>(particles);
  }
  const double median = bench::median(pace);
  const std::string name = std::string(kScene) + ": ";
  return bench::finish(
      options,
      {{name + "wall time per simulated second", particles, kThreads, median, "s/s", "real time", median, good},
       {name + "fluid's waiting per step", particles, kThreads, bench::median(wait), "us", "wall time",
        bench::median(share), good},
       {name + "memory of both processes, all in", particles, kThreads, bytes, "bytes/particle",
        "record and id, 36 bytes", bytes / 36, good}},
      "of the run");
}
