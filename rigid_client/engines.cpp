// The table of engines: name -> maker. A new engine is one file, its maker's declaration, and a line here.
#include <algorithm>
#include <array>
#include <utility>

#include "rigid_client/engine_factories.h"

namespace ballast {

namespace {

using Maker = std::unique_ptr<Engine> (*)();
constexpr std::array<std::pair<const char*, Maker>, 2> kEngines{{
    {"ode", rigid::make_ode_engine},
    {"free_body", rigid::make_free_body_engine},
}};

}  // namespace

std::vector<std::string> engine_names() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : kEngines) names.emplace_back(name);
  return names;
}

Result<std::unique_ptr<Engine>> make_engine(const std::string& name) {
  const auto found =
      std::find_if(kEngines.begin(), kEngines.end(), [&](const auto& entry) { return name == entry.first; });
  if (found != kEngines.end()) return found->second();
  std::string list;
  for (const std::string& known : engine_names()) list += (list.empty() ? "" : ", ") + known;
  return Error{"there is no rigid engine '" + name + "'", "use one of: " + list, "", kBadInput};
}

}  // namespace ballast
