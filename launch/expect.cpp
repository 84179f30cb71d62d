// Expectations on columns and on the ledger, and what all kinds share.
#include "launch/expect.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>

namespace ballast::launch {

using nlohmann::json;

namespace {

constexpr double kEdge = 1e-12;  // relative slack at a bound, for sums rounded differently

constexpr double kUnforeseenLoss = 0.01;  // share of the fluid; a run whose scene says nothing of it may lose less

/// Particles at the start of the run.
double particles_at_start(const json& particles) {
  return particles.value("fluid", 0.0) + particles.value("left_domain", 0.0);
}

Verdict judge_lost(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = "lost particles"};
  const json particles = evidence.fluid.value("particles", json::object());
  if (particles.contains("lost")) {
    v.value = particles["lost"].get<double>();
  } else if (evidence.scene.fluids.empty()) {
    v.value = 0;
  } else {
    v.note = "the fluid process did not report it";
  }
  v.high = expect.within_relative.value_or(0) * particles_at_start(particles);
  decide(v);
  return v;
}

Verdict judge_column(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = expect.column + " " + expect.statistic};
  const auto series = find_series(evidence, expect.column, expect.from, expect.to);
  if (!series) {
    v.note = "there is no such column in bodies.csv or probes.csv";
  } else if (series->values.empty()) {
    v.note = "no row lies in the window of time";
  } else {
    v.value = statistic(*series, expect.statistic);
    if (!std::isfinite(v.value)) v.note = "some of its values are not finite";
  }
  set_bounds(v, expect, 1, std::nullopt);
  decide(v);
  return v;
}

Verdict judge_momentum(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = "momentum imbalance"};
  if (evidence.momentum_imbalance)
    v.value = *evidence.momentum_imbalance;
  else
    v.note = "the two processes did not both report the momentum exchanged";
  set_bounds(v, expect, 1, 1e-9);
  decide(v);
  return v;
}

json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

}  // namespace

bool matches(const std::string& pattern, const std::string& name) {
  return pattern.empty() || fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

std::string Verdict::bound_text() const {
  const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
  if (has_low && has_high) return fmt::format("{:.4g} .. {:.4g}", low, high);
  if (has_high) return fmt::format("<= {:.4g}", high);
  if (has_low) return fmt::format(">= {:.4g}", low);
  return "no bound";
}

json Verdict::json() const {
  nlohmann::json out = {{"name", name}, {"value", number(value)}};
  const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
  if (has_low && has_high)
    out["bound"] = {low, high};
  else
    out["bound"] = number(has_high ? high : low);
  out["pass"] = reference_missing || !not_judged.empty() ? nlohmann::json(nullptr) : nlohmann::json(pass);
  if (!not_judged.empty()) out["not_judged"] = not_judged;
  if (reference_missing) out["reference_installed"] = false;
  if (!note.empty()) out["note"] = note;
  return out;
}

void set_bounds(Verdict& v, const Expect& expect, double target_scale, std::optional<double> fallback_high) {
  if (expect.equals) {
    double tolerance = expect.within.value_or(0);
    if (expect.within_relative)
      tolerance = std::max(tolerance, *expect.within_relative * std::abs(*expect.equals) * target_scale);
    v.low = *expect.equals - tolerance;
    v.high = *expect.equals + tolerance;
  }
  if (expect.below) v.high = std::min(v.high, *expect.below);
  if (expect.above) v.low = std::max(v.low, *expect.above);
  if (!expect.equals && !expect.below && !expect.above && fallback_high) v.high = *fallback_high;
}

void decide(Verdict& v) {
  const auto slack = [](double bound) { return std::isfinite(bound) ? kEdge * std::abs(bound) : 0.0; };
  const bool bounded = std::isfinite(v.low) || std::isfinite(v.high);
  if (!bounded && v.note.empty()) v.note = "the scene gives no bound";
  v.pass = bounded && std::isfinite(v.value) && v.value >= v.low - slack(v.low) && v.value <= v.high + slack(v.high);
}

std::optional<Series> find_series(const Evidence& evidence, const std::string& column, double from, double to) {
  for (const Table* table : {&evidence.body_rows, &evidence.probe_rows}) {
    if (const auto c = table->column(column)) return window(*table, *c, from, to);
  }
  return std::nullopt;
}

Verdict judge_one(const Expect& expect, const Evidence& evidence) {
  switch (expect.kind) {
    case ExpectKind::kLostParticles:
      return judge_lost(expect, evidence);
    case ExpectKind::kMoved:
      return judge_moved(expect, evidence);
    case ExpectKind::kInside:
      return judge_inside(expect, evidence);
    case ExpectKind::kColumn:
      return judge_column(expect, evidence);
    case ExpectKind::kInitialAcceleration:
      return judge_initial_acceleration(expect, evidence);
    case ExpectKind::kJitter:
      return judge_jitter(expect, evidence);
    case ExpectKind::kMomentum:
      return judge_momentum(expect, evidence);
    case ExpectKind::kTotalMomentum:
      return judge_total_momentum(expect, evidence);
    case ExpectKind::kTrack:
      return judge_track(expect, evidence);
  }
  return Verdict{.name = "unknown expectation"};
}

std::vector<Verdict> judge(const Evidence& evidence) {
  std::vector<Verdict> out;
  for (const Expect& expect : evidence.scene.expects) out.push_back(judge_one(expect, evidence));
  return out;
}

std::optional<Verdict> judge_unforeseen_loss(const Evidence& evidence) {
  const auto speaks_of_it = [](const Expect& e) {
    return e.kind == ExpectKind::kLostParticles || e.kind == ExpectKind::kInside;
  };
  if (std::ranges::any_of(evidence.scene.expects, speaks_of_it)) return std::nullopt;
  const json particles = evidence.fluid.value("particles", json::object());
  const double start = particles_at_start(particles), lost = particles.value("lost", 0.0);
  if (!(lost > kUnforeseenLoss * start)) return std::nullopt;
  Verdict v{.name = "lost particles", .value = lost, .high = kUnforeseenLoss * start};
  v.note = fmt::format(
      "{:.3g} % of the fluid, and the scene does not say that it may; {} left the domain, {} ended outside every "
      "container or inside a solid: look at the warnings and, with --vtk, at where they are; if it is meant to leave, "
      "write expect: - {{ lost_particles: {:.0f} % }}",
      100 * lost / start, particles.value("left_domain", 0), particles.value("misplaced", 0),
      std::min(100.0, std::ceil(100 * lost / start / 5 + 0.5) * 5));
  return v;
}

}  // namespace ballast::launch
