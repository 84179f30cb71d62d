// The scene's expectations judged on what a run has left: rows, final reports and the momentum ledger.
#pragma once
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/bodies.h"
#include "common/scene/scene.h"
#include "launch/table.h"

namespace ballast::launch {

/// All that an expectation may look at.
struct Evidence {
  const Scene& scene;
  const std::vector<Body>& bodies;
  const Table& body_rows;
  const Table& probe_rows;
  const nlohmann::json& fluid;  ///< final report of the fluid process; empty object if there was none
  const nlohmann::json& rigid;  ///< the same of the rigid process
  std::optional<double> momentum_imbalance;
  std::vector<std::string> reference_folders;
};

/// How one expectation came out. Bounds that are infinite do not exist.
struct Verdict {
  std::string name;
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool pass = false;
  bool reference_missing = false;  ///< neither passed nor missed
  std::string not_judged{};        ///< why neither passed nor missed: the run did not come to its end
  std::string note{};              ///< why there is no value, or what else a reader should know

  std::string bound_text() const;  ///< "<= 0", "0.1 .. 0.2"
  nlohmann::json json() const;     ///< {name, value, bound, pass}; bound: a number, or [low, high]
};

std::vector<Verdict> judge(const Evidence& evidence);

/// A run that loses more than 1 % of its fluid has missed something, unless its scene says how much may be lost.
std::optional<Verdict> judge_unforeseen_loss(const Evidence& evidence);

/// One verdict; public for the tests. Splits by ExpectKind.
Verdict judge_one(const Expect& expect, const Evidence& evidence);

/// True if `name` fits `pattern`, in which * stands for anything.
bool matches(const std::string& pattern, const std::string& name);

// The kinds that need bodies, in expect_bodies.cpp; the one that needs a file, in expect_track.cpp.
Verdict judge_moved(const Expect& expect, const Evidence& evidence);
Verdict judge_inside(const Expect& expect, const Evidence& evidence);
Verdict judge_initial_acceleration(const Expect& expect, const Evidence& evidence);
Verdict judge_jitter(const Expect& expect, const Evidence& evidence);
Verdict judge_total_momentum(const Expect& expect, const Evidence& evidence);
Verdict judge_track(const Expect& expect, const Evidence& evidence);

/// Sets the bounds of `verdict` from equals/within/below/above; `fallback_high` where the scene gives none.
void set_bounds(Verdict& verdict, const Expect& expect, double target_scale, std::optional<double> fallback_high);
/// pass = value is finite and within the bounds.
void decide(Verdict& verdict);
/// The samples of a column of bodies.csv or probes.csv in [from, to]; nothing if there is no such column.
std::optional<Series> find_series(const Evidence& evidence, const std::string& column, double from, double to);

}  // namespace ballast::launch
