// scene.yaml -> Scene: strict, SI with optional units, every error with file, line, column and cure.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/result.h"
#include "common/scene/scene.h"

namespace ballast {

/// `path=value` from the command line, e.g. {"fluids.water.viscosity", "0.1"}; list items are named by `name` or index.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Reads and checks a scene file. Mesh paths in the result are absolute. Expands `repeat`. Errors: exit code 2.
Result<Scene> read_scene(const std::string& path, const Overrides& overrides = {});

/// The same from text; `file` is used in messages and as base of relative paths.
Result<Scene> read_scene_text(const std::string& text, const std::string& file, const Overrides& overrides = {});

/// The full effective scene as YAML text that read_scene_text reads back to an equal scene (defaults written out).
std::string print_scene(const Scene& scene);

/// 64-bit hash of print_scene.
std::uint64_t scene_hash(const Scene& scene);

/// Keys in which two scenes differ, as paths of the printed scene: "/world/spacing", "/models/crate/density"; list
/// items by name or index.
std::vector<std::string> scene_differences(const Scene& a, const Scene& b);

/// JSON Schema (draft 2020-12) of a scene file, from the same list of keys that the reader uses.
std::string scene_schema();

/// Every key with unit, meaning and default, one line each, from the same list.
std::string scene_help();

}  // namespace ballast
