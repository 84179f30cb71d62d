// Benchmarks are programs of their own with a checked answer; here they are only run and merged.
#include "launch/bench.h"

#include <fmt/format.h>
#include <stdio.h>
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/output/whole_file.h"
#include "launch/children.h"

namespace ballast::launch {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

std::vector<fs::path> programs(const std::string& filter) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::directory_iterator(program_folder())) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with("_bench") && name.find(filter) != std::string::npos) out.push_back(entry.path());
  }
  std::ranges::sort(out);
  return out;
}

/// Standard output of `program --json` as a JSON list; discarded if it failed.
json results_of(const fs::path& program) {
  std::string text;
  FILE* pipe = popen(fmt::format("'{}' --json", program.string()).c_str(), "r");
  if (pipe == nullptr) return json::value_t::discarded;
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  const int status = pclose(pipe);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return json::value_t::discarded;
  json list = json::parse(text, nullptr, false);
  return list.is_array() ? list : json(json::value_t::discarded);
}

std::string cell(const json& row, const char* key) {
  if (!row.contains(key) || row[key].is_null()) return "-";
  if (row[key].is_string()) return row[key].get<std::string>();
  if (row[key].is_number_float()) return fmt::format("{:.4g}", row[key].get<double>());
  return row[key].dump();
}

}  // namespace

int bench(const std::string& out, const std::string& filter) {
  const std::vector<fs::path> found = programs(filter);
  if (found.empty()) {
    fmt::print(stderr, "ballast: no program *{}*_bench in {}\n  build the benchmarks: they belong to all targets\n",
               filter, program_folder());
    return kBadInput;
  }
  json all = json::array();
  int exit = kFine;
  constexpr auto kLine = "{:<48} {:>9} {:>3} {:>10} {:<17} {:>8} {:<30} {}\n";
  fmt::print(kLine, "name", "particles", "thr", "value", "unit", "ratio", "to", "checked");
  std::fflush(stdout);
  for (const fs::path& program : found) {
    const json list = results_of(program);
    if (list.is_discarded()) {
      fmt::print(stderr, "ballast: {} failed or did not print a JSON list\n", program.filename().string());
      exit = kProcessFailed;
      continue;
    }
    for (const json& row : list) {
      fmt::print(kLine, cell(row, "name"), cell(row, "particles"), cell(row, "threads"), cell(row, "value"),
                 cell(row, "unit"), cell(row, "ratio"), cell(row, "yardstick"), cell(row, "checked"));
      if (row.contains("checked") && row["checked"] == false) exit = kProcessFailed;
      all.push_back(row);
    }
    std::fflush(stdout);
  }
  std::error_code failed;
  fs::create_directories(out, failed);
  if (Status s = output::write_whole((fs::path(out) / "bench.json").string(), all.dump(2) + "\n"); !s) {
    fmt::print(stderr, "ballast: {}\n", s.error().text());
    return s.error().exit_code;
  }
  return exit;
}

}  // namespace ballast::launch
