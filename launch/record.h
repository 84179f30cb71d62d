// The run record, record.json, and the five lines that end every run.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "launch/collect.h"
#include "launch/drive.h"
#include "launch/expect.h"
#include "launch/prepare.h"

namespace ballast::launch {

/// |momentum given - received| / scale from the two final reports; nothing if one of them does not say.
std::optional<double> momentum_imbalance(const nlohmann::json& fluid, const nlohmann::json& rigid);

/// Everything about a run that has ended; keys as DESIGN.md section 11 fixes them. What nobody measured is absent or
/// null.
nlohmann::json make_record(const Prepared& prepared, const Outcome& outcome, const Collector& collector,
                           const std::vector<Verdict>& verdicts, int threads);

/// A line per fluid: volume and mass asked, what bodies took of it, volume and mass got.
std::vector<std::string> fill_lines(const nlohmann::json& fluid_report);

/// The last five lines of a run: what, how fast, how large, how wrong, where.
std::vector<std::string> summary_lines(const nlohmann::json& record, const std::string& out_dir);

}  // namespace ballast::launch
