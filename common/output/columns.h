// Names of the columns of bodies.csv and probes.csv, so that their writers and readers cannot disagree.
#pragma once
#include <string>
#include <vector>

#include "common/scene/scene.h"

namespace ballast::output {

/// Values per body in a row of bodies.csv and in a kBodies frame: position, orientation, velocity, angular velocity,
/// acceleration, force and torque of the fluid.
inline constexpr int kBodyValues = 22;

/// Indices into scene.models of the models in bodies.csv and in kBodies frames: all that are not static, in order.
std::vector<int> moving_models(const Scene& scene);

/// "crate.x", "crate.y", ...: kBodyValues for every moving model. The column "t" in front of them is not listed.
std::vector<std::string> body_columns(const Scene& scene);

/// Columns of probes.csv and values of a kProbes frame, in the order of scene.probes (see Probe in scene.h); without
/// "t".
std::vector<std::string> probe_columns(const Scene& scene);

}  // namespace ballast::output
