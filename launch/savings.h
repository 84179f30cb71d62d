// The table of what a run did without: what each part left out saved in this run, and what it changed.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "launch/collect.h"
#include "launch/drive.h"
#include "launch/prepare.h"

namespace ballast::launch {

/// What `from` has under `key`, or null.
inline nlohmann::json get(const nlohmann::json& from, const char* key) {
  return from.is_object() && from.contains(key) ? from[key] : nlohmann::json(nullptr);
}

/// Rows {what, why, saved, difference, saved_s, saved_bytes}: the plan's, then those of the processes. saved_s (s of
/// wall time) and saved_bytes (of memory, messages or files) are counted in this run; null where nobody can count them.
nlohmann::json savings(const Prepared& prepared, const Outcome& outcome, const Collector& collector);

/// The table as text, from the record.
std::vector<std::string> savings_lines(const nlohmann::json& record);

/// One line about the run's sleep; empty where it never slept.
std::string sleep_line(const nlohmann::json& record);

}  // namespace ballast::launch
