// Merging two final reports and the coordinator's own sums into one record. Missing keys stay missing: no number is
// invented.
#include "launch/record.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <fstream>
#include <thread>

#include "common/scene/reader.h"
#include "launch/act.h"
#include "launch/savings.h"

namespace ballast::launch {

using exchange::Role;
using nlohmann::json;

namespace {

std::optional<std::array<double, 3>> vector_of(const json& from, const char* key) {
  const json value = get(get(from, "ledger"), key);
  if (!value.is_array() || value.size() != 3) return std::nullopt;
  return std::array<double, 3>{value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

std::string machine() {
  std::string cpu = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("model name")) continue;
    cpu = line.substr(line.find(':') + 2);
    break;
  }
  utsname name{};
  uname(&name);
  return fmt::format("{}, {} cores, {} {}", cpu, std::thread::hardware_concurrency(), name.sysname, name.release);
}

/// One hash of particles and bodies: FNV-1a over the two hexadecimal hashes.
json joined_hash(const json& fluid, const json& rigid) {
  const json f = get(fluid, "state_hash"), r = get(rigid, "state_hash");
  if (!f.is_string()) return r;
  if (!r.is_string()) return f;
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (char c : f.get<std::string>() + r.get<std::string>())
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return fmt::format("{:016x}", hash);
}

/// The rigid process has one thread; how many "all cores" (0 asked) are, only the fluid process knows.
json threads_used(const json& fluid, bool has_fluid, int asked) {
  if (const json reported = get(fluid, "threads"); reported.is_number()) return reported;
  if (!has_fluid) return 1;
  return asked > 0 ? json(asked) : json(nullptr);
}

json merged_ledger(const json& fluid, const json& rigid) {
  json out = json::object();
  for (const json* report : {&fluid, &rigid}) {
    const json part = get(*report, "ledger");
    if (part.is_object()) out.update(part, true);
  }
  const auto given = vector_of(fluid, "momentum_to_bodies_N_s"), received = vector_of(rigid, "momentum_received_N_s");
  if (given) out["momentum_to_bodies_N_s"] = *given;
  if (received) out["momentum_from_fluid_N_s"] = *received;
  out.erase("momentum_received_N_s");
  const auto imbalance = momentum_imbalance(fluid, rigid);
  out["imbalance_relative"] = imbalance ? json(*imbalance) : json(nullptr);
  return out;
}

json merged_stages(const json& fluid, const json& rigid) {
  json out = json::object();
  const json f = get(fluid, "stages"), r = get(rigid, "stages");
  if (f.is_object()) out.update(f);
  if (!r.is_object()) return out;
  for (const auto& [name, seconds] : r.items()) out["rigid." + name] = seconds;
  return out;
}

json merged_error(const json& fluid, const StepTotals& totals, bool has_fluid) {
  json out = get(fluid, "error");
  if (!out.is_object()) out = json::object();
  if (has_fluid && totals.steps > 0) {
    if (!out.contains("density_mean"))
      out["density_mean"] = totals.density_mean_sum / static_cast<double>(totals.steps);
    const char* names[] = {"density_mean", "density_max", "pressure_residual", "interface_residual"};
    for (std::size_t k = 1; k < 4; ++k) {
      if (!out.contains(names[k])) out[names[k]] = totals.max_error[k];
    }
  }
  return out;
}

void add_lists(json& record, const Prepared& prepared, const Outcome& outcome, const Collector& collector,
               const std::vector<Verdict>& verdicts) {
  record["expect"] = json::array();
  for (const Verdict& v : verdicts) record["expect"].push_back(v.json());
  record["left_out"] = savings(prepared, outcome, collector);
  record["warnings"] = prepared.oddities;
  for (const std::string& warning : collector.warnings()) record["warnings"].push_back(warning);
  if (const json failed = get(outcome.lcm, "failed"); failed.is_number() && failed > 0) {
    record["warnings"].push_back(fmt::format(
        "{} messages over LCM could not be sent to {}: is there a route to it? (ip link set lo multicast on; "
        "ip route add 224.0.0.0/4 dev lo)",
        failed.get<std::uint64_t>(), outcome.lcm["url"].get<std::string>()));
  }
  for (const json* report : {&outcome.fluid, &outcome.rigid}) {
    for (const json& item : get(*report, "warnings").is_array() ? (*report)["warnings"] : json::array()) {
      if (std::ranges::find(record["warnings"], item) == record["warnings"].end()) record["warnings"].push_back(item);
    }
  }
}

constexpr const char* kNone = "not reported";  // by a process that was ended before its final report

/// Of the processes that took part.
std::string memory_text(const json& r) {
  std::string text = "memory:";
  for (const auto& [side, takes_part] :
       {std::pair{"fluid", r["has_fluid"].get<bool>()}, std::pair{"rigid", r["engine"].is_string()}}) {
    if (!takes_part) continue;
    const json& bytes = r["rss_bytes"][side];
    text += fmt::format("{} {} {}", text.ends_with(':') ? "" : ",", side,
                        bytes.is_number() ? fmt::format("{:.0f} MB", bytes.get<double>() / 1e6) : kNone);
    const json arrays = get(r, "array_bytes"), particles = get(r["particles"], "fluid");
    if (side != std::string_view("fluid") || !arrays.is_number() || !particles.is_number() || particles == 0) continue;
    text += fmt::format(" ({:.1f} MB of arrays, {:.2g} kB a particle)", arrays.get<double>() / 1e6,
                        arrays.get<double>() / 1e3 / particles.get<double>());
  }
  return text;
}

std::string percent(const json& value) {
  return value.is_number() ? fmt::format("{:.3g} %", 100 * value.get<double>()) : "none";
}

std::string number_text(const json& value, const char* format) {
  return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : kNone;
}

/// What the exit code means for this run.
std::string exit_text(const json& record) {
  if (const json signal = get(record, "stopped_by"); signal.is_string())
    return "stopped by " + signal.get<std::string>();
  switch (record["exit"].get<int>()) {
    case kFine:
      return "fine";
    case kBadInput:
      return "bad input";
    case kExpectationMissed:
      return "an expectation was missed";
    case kDiverged:
      return "the simulation diverged";
    default:
      return "a process or the exchange failed";
  }
}

std::string bound_text(const json& bound) {
  if (bound.is_array()) return fmt::format("{:.4g} .. {:.4g}", bound[0].get<double>(), bound[1].get<double>());
  return bound.is_number() ? fmt::format("bound {:.4g}", bound.get<double>()) : "no bound";
}

std::string expectations_text(const json& expects) {
  if (expects.empty()) return "no expectations";
  if (const json why = get(expects[0], "not_judged"); why.is_string())
    return "expectations not judged: " + why.get<std::string>();
  constexpr std::size_t kShown = 3;  // the record has all; those missed are listed above the last lines
  std::size_t met = 0, missing = 0, shown = 0;
  std::string values;
  for (const json& e : expects) {
    if (e["pass"].is_null()) {
      ++missing;
    } else if (e["pass"].get<bool>()) {
      ++met;
    }
    if (shown++ >= kShown) continue;
    values += fmt::format("{}{} {} ({})", values.empty() ? ": " : ", ", e["name"].get<std::string>(),
                          number_text(e["value"], "{:.4g}"), bound_text(e["bound"]));
  }
  if (expects.size() > kShown) values += fmt::format(", {} more", expects.size() - kShown);
  std::string text = fmt::format("expectations {} of {} met", met, expects.size());
  if (missing > 0) text += fmt::format(" ({} without reference)", missing);
  return text + values;
}

}  // namespace

std::optional<double> momentum_imbalance(const json& fluid, const json& rigid) {
  const auto given = vector_of(fluid, "momentum_to_bodies_N_s"), received = vector_of(rigid, "momentum_received_N_s");
  const json scale = get(get(fluid, "ledger"), "momentum_scale");
  if (!given || !received || !scale.is_number()) return std::nullopt;
  return momentum_imbalance(*given, *received, scale.get<double>());
}

json make_record(const Prepared& prepared, const Outcome& outcome, const Collector& collector,
                 const std::vector<Verdict>& verdicts, int threads) {
  const Scene& scene = prepared.scene;
  const json &fluid = outcome.fluid, &rigid = outcome.rigid;
  const StepTotals& totals = collector.totals(prepared.fluid ? Role::kFluid : Role::kRigid);
  json record;
  record["scene"] = scene.name;
  record["motion_hash"] = motion_hash(scene);
  record["scene_hash"] = fmt::format("{:016x}", scene_hash(scene));
  record["version"] = BALLAST_VERSION;
  record["machine"] = machine();
  record["threads"] = threads_used(fluid, prepared.fluid, threads);
  record["engine"] = prepared.rigid ? json(scene.coupling.engine) : json(nullptr);
  if (get(rigid, "engine").is_string()) record["engine_details"] = get(rigid, "engine");
  const json scheme = get(fluid, "scheme");
  record["scheme"] = scheme.is_string()                 ? scheme
                     : prepared.fluid && prepared.rigid ? json(scene.coupling.scheme)
                                                        : json(nullptr);
  const Choices& chosen = prepared.choices;
  if (!chosen.scheme_reason.empty()) record["scheme_reason"] = chosen.scheme_reason;
  if (!chosen.pressure_reason.empty()) record["pressure_reason"] = chosen.pressure_reason;
  if (!chosen.shifting_reason.empty()) record["shifting_reason"] = chosen.shifting_reason;
  record["has_fluid"] = prepared.fluid;
  record["exit"] = outcome.exit;
  record["interrupted"] = outcome.interrupted;
  if (outcome.interrupted) record["stopped_by"] = outcome.stopped_by;
  if (!outcome.message.empty()) record["message"] = outcome.message;
  record["simulated_s"] = totals.last.time;
  record["wall_s"] = outcome.wall_s;
  record["total_s"] = outcome.total_s;
  const double simulated = totals.last.time - outcome.resumed_time;
  record["real_time_factor"] = outcome.wall_s > 0 ? json(simulated / outcome.wall_s) : json(nullptr);
  record["steps"] = totals.steps;
  const std::uint64_t done = totals.steps - outcome.resumed_after.value_or(0);
  if (outcome.resumed_after)
    record["resumed"] = {{"after_step", *outcome.resumed_after},
                         {"time_s", outcome.resumed_time},
                         {"covers",
                          "all but wall times: wall_s, total_s, stages, exchange_s and what follows from them "
                          "are since then"}};
  if (outcome.checkpoints > 0) record["checkpoints"] = outcome.checkpoints;
  record["particles"] = get(fluid, "particles");
  const json count = get(record["particles"], "fluid");
  record["particle_steps_per_s"] = count.is_number() && outcome.wall_s > 0
                                       ? json(count.get<double>() * static_cast<double>(done) / outcome.wall_s)
                                       : json(nullptr);
  record["rss_bytes"] = {{"fluid", get(fluid, "rss_bytes")}, {"rigid", get(rigid, "rss_bytes")}};
  record["array_bytes"] = get(fluid, "array_bytes");
  record["bodies"] = scene.models.size();
  record["state_hash"] = joined_hash(fluid, rigid);
  record["error"] = merged_error(fluid, totals, prepared.fluid);
  record["ledger"] = merged_ledger(fluid, rigid);
  record["stages"] = merged_stages(fluid, rigid);
  // What exchange and engine cost the fluid, which works on while the engine does: all its waiting.
  record["exchange_s"] = prepared.fluid && prepared.rigid ? json(totals.wait_s) : json(0.0);
  record["step_limits"] = get(fluid, "step_limits");
  if (const json sleep = get(prepared.fluid ? fluid : rigid, "sleep"); sleep.is_object()) record["sleep"] = sleep;
  if (!outcome.commands.empty()) record["commands"] = outcome.commands;
  if (outcome.stopped_after) record["stopped_after_step"] = *outcome.stopped_after;
  if (outcome.lcm.is_object()) record["lcm"] = outcome.lcm;
  add_lists(record, prepared, outcome, collector, verdicts);
  for (const auto& [side, report] : {std::pair{"fluid_process", &fluid}, std::pair{"rigid_process", &rigid}}) {
    for (const auto& [key, value] : report->items()) {
      if (!record.contains(key)) record[side][key] = value;  // what only this side knows
    }
  }
  return record;
}

std::vector<std::string> fill_lines(const json& fluid) {
  std::vector<std::string> lines;
  const json fills = get(fluid, "fills");
  if (!fills.is_array()) return lines;
  for (const json& f : fills) {
    const double asked = f["volume_asked_m3"], got = f["volume_got_m3"], mass = f["mass_kg"];
    lines.push_back(
        fmt::format("fluid {}: asked {:.5g} m^3, {:.5g} kg; got {:.5g} m^3, {:.5g} kg in {} particles{}",
                    f["fluid"].get<std::string>(), asked, f["mass_asked_kg"].get<double>(), got, mass,
                    f["particles"].get<std::size_t>(),
                    asked - got > 1e-6 * asked ? fmt::format("; {:.3g} m^3 taken by bodies", asked - got) : ""));
  }
  return lines;
}

std::vector<std::string> summary_lines(const json& r, const std::string& out_dir) {
  const json particles = get(r, "particles");
  std::string parts = r["engine"].is_string() ? "engine " + r["engine"].get<std::string>() : "no engine";
  if (r["scheme"].is_string()) parts += ", scheme " + r["scheme"].get<std::string>();
  if (const json coupling = get(get(r, "fluid_process"), "coupling"); coupling.is_object())
    parts += fmt::format(", {:.3g} iterations a step (most {}; {} steps above the tolerance)",
                         coupling["iterations_mean"].get<double>(), coupling["iterations_most"].get<std::uint64_t>(),
                         coupling["tolerance_unreached"].get<std::uint64_t>());
  std::string speed = fmt::format("simulated {:.4g} s in {:.3g} s ({} x real time), {} steps",
                                  r["simulated_s"].get<double>(), r["wall_s"].get<double>(),
                                  number_text(r["real_time_factor"], "{:.3g}"), r["steps"].get<std::uint64_t>());
  if (r.contains("resumed"))
    speed += fmt::format(" (resumed at {:.4g} s, step {})", r["resumed"]["time_s"].get<double>(),
                         r["resumed"]["after_step"].get<std::uint64_t>());
  if (r["particle_steps_per_s"].is_number())
    speed += ", " + number_text(r["particle_steps_per_s"], "{:.3g}") + " particle-steps/s";
  std::string size =
      particles.is_object()
          ? fmt::format("{} particles, {} samples of solids, {} lost, {} bodies; {}",
                        number_text(get(particles, "fluid"), "{:.0f}"),
                        number_text(get(particles, "boundary"), "{:.0f}"),
                        number_text(get(particles, "lost"), "{:.0f}"), r["bodies"].get<std::size_t>(), memory_text(r))
          : fmt::format("{}, {} bodies; {}",
                        r["has_fluid"].get<bool>() ? "number of particles not reported" : "no particles",
                        r["bodies"].get<std::size_t>(), memory_text(r));
  std::string errors = r["has_fluid"].get<bool>() ? "density error not reported" : "no fluid, no density error";
  if (particles.is_object()) {
    errors = fmt::format("density error {} (largest {})", percent(get(r["error"], "density_mean")),
                         percent(get(r["error"], "density_max")));
  }
  if (const json gain = get(r["error"], "energy_gain"); gain.is_number())
    errors += fmt::format(", energy gained {}", percent(gain));
  if (const json mean = get(r["error"], "interface_residual_mean"); mean.is_number())
    errors += fmt::format(", interface residual {} (largest {})", percent(mean),
                          percent(get(r["error"], "interface_residual")));
  if (r["ledger"]["imbalance_relative"].is_number()) {
    errors += fmt::format(", momentum imbalance {:.2g}", r["ledger"]["imbalance_relative"].get<double>());
  }
  errors += "; " + expectations_text(r["expect"]);
  std::vector<std::string> lines{
      fmt::format("{}: {}; exit {} ({})", r["scene"].get<std::string>(), parts, r["exit"].get<int>(), exit_text(r)),
      std::move(speed), std::move(size), std::move(errors), "outputs in " + out_dir};
  if (r.contains("stopped_after_step"))
    lines.insert(lines.begin() + 1,
                 fmt::format("stopped by a command after step {}, at t = {:.4g} s",
                             r["stopped_after_step"].get<std::uint64_t>(), r["simulated_s"].get<double>()));
  if (std::string slept = sleep_line(r); !slept.empty()) lines.insert(lines.begin() + 2, std::move(slept));
  return lines;
}

}  // namespace ballast::launch
