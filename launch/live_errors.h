// The errors of a run that need no reference, as far as it has come.
#pragma once
#include <optional>

namespace ballast::launch {

/// All relative. Nothing: the run has no such figure, or none yet.
struct LiveErrors {
  std::optional<double> density_mean = {}, density_max = {};  ///< of the particles, as measured last
  std::optional<double> pressure = {};                        ///< left by the last solve; an explicit solver has none
  std::optional<double> interface = {};                       ///< fluid against bodies in the last step
  std::optional<double> mass = {};      ///< `ledger.mass_drift` of the record: less than 0 is lost
  std::optional<double> momentum = {};  ///< its `ledger.imbalance_relative`
  std::optional<double> energy = {};    ///< its `error.energy_gain`
};

}  // namespace ballast::launch
