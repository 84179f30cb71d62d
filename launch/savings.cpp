// Counting what was left out: rows times sizes, steps times messages, and what the processes measured.
#include "launch/savings.h"

#include <fmt/format.h>

#include <optional>

#include "common/output/columns.h"

namespace ballast::launch {

using exchange::Role;
using nlohmann::json;

namespace {

/// What the run had of everything that is counted.
struct Counts {
  double steps, rows, bodies, particles;
  /// Of one step's order and answer.
  double exchange_bytes() const {
    return sizeof(exchange::Order) + sizeof(exchange::Answer) +
           bodies * static_cast<double>(sizeof(exchange::Wrench) + sizeof(exchange::BodyState));
  }
};

/// Bytes that one part of the plan would have cost; nothing where that depends on what it would have found.
std::optional<double> bytes_of(const std::string& what, const Scene& scene, const Counts& n) {
  if (what == kFluidProcess || what == kRigidProcess) return n.steps * n.exchange_bytes();
  if (what == kMessages) {
    const double sample = scene.fluids.empty() ? 0 : std::min<double>(n.particles, scene.output.lcm_particles);
    const double fluid = sizeof(exchange::FluidStatistics) + sizeof(exchange::ParticleSetHead) +
                         sample * sizeof(exchange::ParticleSample);
    return n.rows * (n.bodies * sizeof(double) * output::kBodyValues + (scene.fluids.empty() ? 0 : fluid));
  }
  // Position, velocity, pressure and density in single precision; surfaces of the bodies come on top.
  if (what == kVtk) return n.rows * n.particles * 8 * sizeof(float);
  if (what == kContactSets) return static_cast<double>(exchange::SegmentPlan{}.contact_bytes);
  if (what == kViscous) return n.particles * 4 * sizeof(float);
  if (what == kShifting) return n.particles * sizeof(float) * 8;
  if (what == kDensities || what == kCompression) return n.particles * sizeof(float);
  return std::nullopt;
}

json asleep(const json& sleep) {
  const double seconds = sleep["asleep_s"].get<double>();
  const std::string looking = fmt::format("; looking for rest took {:.2g} s", sleep["watched_s"].get<double>());
  json out{
      {"what", "steps asleep"},
      {"why", fmt::format("nothing was faster than {:g} m/s for {:g} s", sleep["speed"].get<double>(),
                          sleep["after"].get<double>())},
      {"saved", fmt::format("the fluid's and the engine's work on {:.4g} s of simulated time{}", seconds, looking)},
      {"difference",
       fmt::format(
           "{:.2g} m at most (bound: what stays slower than that), {:.2g} m at the speed with which it fell asleep",
           sleep["bound_m"].get<double>(), sleep["drift_m"].get<double>())},
      {"saved_s", sleep["saved_s"]},
      {"saved_bytes", nullptr}};
  if (seconds > 0) return out;
  const json because = get(sleep, "awake_because");
  out["why"] = "not left out: " + (because.is_string() ? because.get<std::string>() : "it never came to rest");
  out["saved"] = "nothing" + looking;
  out["difference"] = "none";
  out["saved_s"] = 0;
  return out;
}

std::string amount(const json& row) {
  std::string text;
  if (row["saved_s"].is_number()) text = fmt::format("{:.3g} s", row["saved_s"].get<double>());
  if (!row["saved_bytes"].is_number()) return text.empty() ? "-" : text;
  const double bytes = row["saved_bytes"];
  const std::string size = bytes < 1e6 ? fmt::format("{:.3g} kB", bytes / 1e3) : fmt::format("{:.3g} MB", bytes / 1e6);
  return text.empty() ? size : text + ", " + size;
}

}  // namespace

json savings(const Prepared& prepared, const Outcome& outcome, const Collector& collector) {
  const StepTotals& totals = collector.totals(prepared.fluid ? Role::kFluid : Role::kRigid);
  const json particles = get(get(outcome.fluid, "particles"), "fluid");
  const Counts counts{static_cast<double>(totals.steps),
                      static_cast<double>(std::max(collector.bodies().rows(), collector.probes().rows())),
                      static_cast<double>(prepared.scene.models.size()),
                      particles.is_number() ? particles.get<double>() : 0};
  json out = json::array();
  for (const LeftOut& l : prepared.left_out) {
    const auto bytes = bytes_of(l.what, prepared.scene, counts);
    out.push_back({{"what", l.what},
                   {"why", l.why},
                   {"saved", l.saved},
                   {"difference", l.difference},
                   {"saved_s", nullptr},
                   {"saved_bytes", bytes ? json(*bytes) : json(nullptr)}});
  }
  const json& decider = prepared.fluid ? outcome.fluid : outcome.rigid;
  if (const json sleep = get(decider, "sleep"); sleep.is_object()) out.push_back(asleep(sleep));
  for (const json* report : {&outcome.fluid, &outcome.rigid})
    if (const json rows = get(*report, "left_out"); rows.is_array()) out.insert(out.end(), rows.begin(), rows.end());
  return out;
}

std::vector<std::string> savings_lines(const json& record) {
  std::vector<std::string> lines{"left out, with what it saved in this run and what it changed"};
  for (const json& row : record["left_out"]) {
    lines.push_back(
        fmt::format("  {:<24} {:>16}  {}", row["what"].get<std::string>(), amount(row), row["why"].get<std::string>()));
    lines.push_back(fmt::format("  {:<24} {:>16}  saves {}; difference: {}", "", "", row["saved"].get<std::string>(),
                                row["difference"].get<std::string>()));
  }
  return lines;
}

std::string sleep_line(const json& record) {
  const json sleep = get(record, "sleep");
  if (!sleep.is_object()) return "";
  if (sleep["naps"].empty()) {
    const json because = get(sleep, "awake_because");
    return "never asleep: " + (because.is_string()
                                   ? because.get<std::string>()
                                   : fmt::format("something was always faster than {:g} m/s, or had been within {:g} s",
                                                 sleep["speed"].get<double>(), sleep["after"].get<double>()));
  }
  const double saved = sleep["saved_s"];
  return fmt::format(
      "asleep for {:.4g} s of simulated time, from t = {:.4g} s, {} time(s): saved about {:.2g} s; moves of "
      "at most {:.2g} m left out ({:.1g} m at the speed it had)",
      sleep["asleep_s"].get<double>(), sleep["naps"][0]["from"].get<double>(), sleep["naps"].size(), saved,
      sleep["bound_m"].get<double>(), sleep["drift_m"].get<double>());
}

}  // namespace ballast::launch
