// `ballast bench`: runs every *_bench program beside this one and merges what they measured.
#pragma once
#include <string>

namespace ballast::launch {

/// Each program X_bench is called with --json and prints a JSON list of {name, particles, threads, simd, value, unit,
/// yardstick, ratio, checked}. Writes out/bench.json (the merged list), prints a table. Exit code 5 if one fails or a
/// figure comes from an answer that was not right.
int bench(const std::string& out, const std::string& filter);

}  // namespace ballast::launch
