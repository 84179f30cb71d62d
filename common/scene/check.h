// What no single value can show: names that refer to nothing, pairs that contradict each other, dimension 2.
#pragma once
#include "common/scene/read_value.h"
#include "common/scene/scene.h"

namespace ballast::scene {

/// Replaces every model that has a `repeat` by its copies. `state.repeats` runs parallel to the models.
void expand_repeats(Scene& scene, ReadState& state);

/// Checks the expanded scene; the first complaint is in state.error. `root` is the place of the whole document.
void check_scene(const Scene& scene, const Place& root, ReadState& state);

/// Names of all models, for messages.
std::vector<std::string> model_names(const Scene& scene);

/// Has an inside that can hold fluid and bodies.
bool can_contain(const Shape& shape);

/// The same for probes and expectations (called by check_scene).
void check_measurements(const Scene& scene, ReadState& state);

}  // namespace ballast::scene
