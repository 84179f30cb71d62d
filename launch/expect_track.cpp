// Expectation that a column follows a published or exact curve, read from a CSV file of two columns.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "launch/expect.h"

namespace ballast::launch {

namespace {

/// Reads "time,value" rows; lines with # and one header line of words are skipped.
Series read_reference(const std::filesystem::path& path) {
  Series out;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    double t = 0, value = 0;
    char comma = 0;
    if (!(words >> t >> comma >> value) || comma != ',') continue;
    out.times.push_back(t);
    out.values.push_back(value);
  }
  return out;
}

std::filesystem::path find_reference(const Evidence& evidence, const std::string& name) {
  for (const std::string& folder : evidence.reference_folders) {
    const std::filesystem::path path = std::filesystem::path(folder) / name;
    if (std::filesystem::is_regular_file(path)) return path;
  }
  return {};
}

}  // namespace

Verdict judge_track(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = fmt::format("{} against {}", expect.column, expect.reference)};
  const std::filesystem::path path = find_reference(evidence, expect.reference);
  if (path.empty()) {
    v.reference_missing = true;
    v.note = "reference not installed";
    return v;
  }
  const Series reference = read_reference(path);
  const auto simulated = find_series(evidence, expect.column, -1e300, 1e300);
  if (reference.times.empty() || !simulated) {
    v.note = reference.times.empty() ? "the reference has no rows of two numbers" : "there is no such column";
    decide(v);
    return v;
  }
  double squares = 0, low = 1e300, high = -1e300;
  std::size_t used = 0;
  for (std::size_t i = 0; i < reference.times.size(); ++i) {
    const double t = reference.times[i] + expect.time_offset;
    const auto value = t < expect.from || t > expect.to ? std::nullopt : interpolate(*simulated, t);
    if (!value) continue;
    const double miss = *value - expect.value_offset - reference.values[i];
    squares += miss * miss;
    low = std::min(low, reference.values[i]);
    high = std::max(high, reference.values[i]);
    ++used;
  }
  if (used == 0) {
    v.note = "no sample of the reference lies in the window of time";
  } else {
    v.value = std::sqrt(squares / static_cast<double>(used));
    v.note = fmt::format("rms over {} samples of the reference", used);
    // A relative bound is of the range of the samples used.
    if (expect.within_relative) v.high = *expect.within_relative * (high - low);
  }
  if (expect.within) v.high = *expect.within;
  if (expect.below) v.high = std::min(v.high, *expect.below);
  decide(v);
  return v;
}

}  // namespace ballast::launch
