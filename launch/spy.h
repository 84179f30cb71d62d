// `ballast spy`: lcm-spy with Ballast's types; and handing over to the monitors.
#pragma once
#include <string>
#include <vector>

#include "common/result.h"

namespace ballast::launch {

/// Whether PATH leads to a program of this name.
bool on_path(const std::string& program);

/// The jars that lcm-spy needs.
struct SpyFiles {
  std::string types, lcm, charts;
};
/// The error names the package that brings what is missing.
Result<SpyFiles> find_spy();

/// Becomes lcm-spy, which shows every channel and its fields. Returns only if it cannot: the exit code.
int spy(const std::string& lcm_url);

/// Becomes ballast_monitor with these arguments (watch ..., tap ...). Returns only if it cannot: the exit code.
int become_monitor(std::vector<std::string> arguments);

}  // namespace ballast::launch
