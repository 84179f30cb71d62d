// What the benchmarks share: their two options, the rows of `ballast bench`, medians.
#pragma once
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/result.h"

namespace ballast::bench {

/// PROGRAM [--repetitions N] [--json [FILE]]; --json without a file prints the list instead of the table.
struct Options {
  int repetitions = 0;
  bool json = false;
  std::string file;

  /// False after a message if the words are not understood.
  bool parse(int argc, char** argv, int usual) {
    repetitions = usual;
    for (int i = 1; i < argc; ++i) {
      const bool has_value = i + 1 < argc && argv[i + 1][0] != '-';
      if (std::strcmp(argv[i], "--json") == 0) {
        json = true;
        if (has_value) file = argv[++i];
      } else if (std::strcmp(argv[i], "--repetitions") == 0 && has_value) {
        repetitions = std::max(1, std::atoi(argv[++i]));
      } else {
        std::fprintf(stderr, "usage: %s [--repetitions N] [--json [FILE]]\n", argv[0]);
        return false;
      }
    }
    return true;
  }
};

struct Row {
  std::string name;
  std::size_t particles = 0;
  int threads = 1;
  double value = 0;
  std::string unit, yardstick;
  double ratio = 1;
  bool checked = true;
};

/// Prints the table, or the list where it was asked for on standard output. The exit code of the program.
inline int finish(const Options& options, const std::vector<Row>& rows, const std::string& simd) {
  nlohmann::json list = nlohmann::json::array();
  bool good = true;
  const bool table = !options.json || !options.file.empty();
  if (table)
    std::printf("%-42s %9s %3s %12s %-22s %8s  %-34s %s\n", "name", "particles", "thr", "value", "unit", "ratio", "to",
                "checked");
  for (const Row& r : rows) {
    good = good && r.checked;
    list.push_back({{"name", r.name},
                    {"particles", r.particles},
                    {"threads", r.threads},
                    {"simd", simd},
                    {"value", r.value},
                    {"unit", r.unit},
                    {"yardstick", r.yardstick},
                    {"ratio", r.ratio},
                    {"checked", r.checked}});
    if (table)
      std::printf("%-42s %9zu %3d %12.5g %-22s %8.3f  %-34s %s\n", r.name.c_str(), r.particles, r.threads, r.value,
                  r.unit.c_str(), r.ratio, r.yardstick.c_str(), r.checked ? "yes" : "NO");
  }
  if (options.json && options.file.empty()) std::printf("%s\n", list.dump(2).c_str());
  if (!options.file.empty()) {
    std::ofstream out(options.file);
    if (!(out << list.dump(2) << "\n")) {
      std::fprintf(stderr, "cannot write %s\n", options.file.c_str());
      return kBadInput;
    }
  }
  return good ? kFine : kProcessFailed;
}

/// Idle threads of the pool sleep as soon as those of the fluid process do. Before they are first used.
inline void let_idle_threads_sleep() { setenv("KMP_BLOCKTIME", "1", 0); }

inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

}  // namespace ballast::bench
