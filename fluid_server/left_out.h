// What the fluid process did without in a run: rows of the record's table (launch/savings.h).
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "fluid_server/step/interface.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

/// `skip_search`: the scene's; `no_energy_bound`: why there is none, empty if there is; `computed`: steps that were not
/// slept through.
nlohmann::json left_out_rows(const WcsphFluid& fluid, bool skip_search, const std::string& no_energy_bound,
                             const Interface& interface, std::uint64_t computed);

}  // namespace ballast::fluid
