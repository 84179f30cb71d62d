// What the final report of a process says of its sleep.
#pragma once
#include <nlohmann/json.hpp>

#include "common/exchange/sleep.h"

namespace ballast::exchange {

/// SI units; null where the scene does not ask for sleep.
inline nlohmann::json sleep_json(const Sleep& sleep) {
  if (!(sleep.speed() > 0)) return nullptr;
  nlohmann::json out{{"speed", sleep.speed()},   {"after", sleep.after()},       {"asleep_s", sleep.seconds()},
                     {"steps", sleep.steps()},   {"bound_m", sleep.bound()},     {"drift_m", sleep.drift()},
                     {"saved_s", sleep.saved()}, {"watched_s", sleep.watched()}, {"naps", nlohmann::json::array()}};
  for (const Sleep::Nap& nap : sleep.naps())
    out["naps"].push_back({{"from", nap.from}, {"to", nap.to}, {"speed", nap.speed}});
  if (!sleep.awake_because().empty()) out["awake_because"] = sleep.awake_because();
  return out;
}

}  // namespace ballast::exchange
