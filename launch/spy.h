// `ballast spy`: lcm-spy with Ballast's types; and handing over to the monitors.
#pragma once
#include <string>
#include <vector>

namespace ballast::launch {

/// Becomes lcm-spy, which shows every channel and its fields. Returns only if it cannot: the exit code.
int spy(const std::string& lcm_url);

/// Becomes ballast_monitor with these arguments (watch ..., tap ...). Returns only if it cannot: the exit code.
int become_monitor(std::vector<std::string> arguments);

}  // namespace ballast::launch
