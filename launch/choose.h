// What `auto` stands for in a scene, by stated rules, and why.
#pragma once
#include <string>

#include "common/scene/scene.h"

namespace ballast::launch {

/// Reasons are empty where the scene itself says what it wants, or has no use for it.
struct Choices {
  std::string pressure_reason, scheme_reason, shifting_reason;
};

/// Puts the choices into the scene: numerics.pressure and shifting where there is a fluid, coupling.scheme where bodies
/// move in it.
Choices choose(Scene& scene);

}  // namespace ballast::launch
