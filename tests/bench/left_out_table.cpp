// What leaving out is worth, for every shipped scene: as shipped, and once more with all that can be asked for
// (messages, contact sets, ParaView files, a picture, checkpoints, never asleep, neighbours searched in every step).
// Prints the record's table of each, then wall times and what was different. Checked: zero bits, or, where the run
// slept, no body farther away than the bound of its sleep.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <vector>

#include "tests/bench/output.h"

namespace {

namespace fs = std::filesystem;
using namespace ballast;
using nlohmann::json;

constexpr const char* kAll =
    "--lcm-url memq:// --set output.vtk=true --set output.picture=true --set output.checkpoint.every=0.1 "
    "--set world.sleep.speed=0 --set numerics.skip_search=false";

/// The record of a run; discarded if there is none.
json run(const fs::path& scene, const fs::path& out, const std::string& options) {
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  const std::string command =
      fmt::format("'{}' run '{}' --quiet --no-expect --out '{}' {} >&2", (programs / "ballast_coordinator").string(),
                  scene.string(), out.string(), options);
  if (std::system(command.c_str()) != 0) return json::value_t::discarded;
  std::ifstream file(out / "record.json");
  return json::parse(file, nullptr, false);
}

/// Positions of the bodies in the last row of bodies.csv, m; none without that file.
std::vector<double> last_positions(const fs::path& out) {
  std::ifstream file(out / "bodies.csv");
  std::string names, line, last, word;
  std::getline(file, names);
  while (std::getline(file, line)) last = line;
  std::vector<double> positions;
  for (std::istringstream head(names), row(last); std::getline(head, word, ',');) {
    std::string value;
    std::getline(row, value, ',');
    if (word.ends_with(".x") || word.ends_with(".y") || word.ends_with(".z")) positions.push_back(std::stod(value));
  }
  return positions;
}

double farthest(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return INFINITY;
  double most = 0;
  for (std::size_t i = 0; i + 2 < a.size(); i += 3)
    most = std::max(most, std::hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]));
  return most;
}

}  // namespace

int main(int argc, char** argv) {
  bench::Options options;
  if (!options.parse(argc, argv, 1)) return kBadInput;
  std::vector<fs::path> scenes;
  for (const auto& entry : fs::directory_iterator(fs::path(BALLAST_SOURCE_DIR) / "scenes"))
    if (entry.path().extension() == ".yaml") scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  const fs::path folder = fs::temp_directory_path() / fmt::format("ballast_left_out_table_{}", getpid());
  std::vector<bench::Row> rows;
  for (const fs::path& scene : scenes) {
    std::vector<double> walls, walls_all;
    std::size_t particles = 0;
    double moved = 0, bound = 0;
    int threads = 1;
    bool same = true;
    for (int k = 0; k < options.repetitions; ++k) {
      const fs::path shipped = folder / "shipped", all = folder / "all";
      const json r = run(scene, shipped, options.json || k > 0 ? "" : "--left-out"), a = run(scene, all, kAll);
      if (!r.is_object() || !a.is_object()) return kProcessFailed;
      walls.push_back(r["wall_s"]);
      walls_all.push_back(a["wall_s"]);
      threads = r["threads"];
      particles = r["particles"].is_object() ? r["particles"]["fluid"].get<std::size_t>() : 0;  // rigid alone: none
      same = same && r["state_hash"] == a["state_hash"];
      moved = std::max(moved, farthest(last_positions(shipped), last_positions(all)));
      if (r.contains("sleep") && r["sleep"].is_object()) bound = r["sleep"]["bound_m"];
      fs::remove_all(folder);
    }
    const double wall = bench::median(walls), all = bench::median(walls_all);
    rows.push_back({"left out: " + scene.stem().string(), particles, threads, wall, "s", "with all of it, same bits",
                    wall / all, same});
    if (same) continue;
    rows.back().yardstick = fmt::format("with all of it, {:.2g} m (<= {:.2g})", moved, bound);
    rows.back().checked = moved <= bound;
  }
  return bench::finish(options, rows, "of the run");
}
