// The commands that do not simulate: check, resolve, schema, plan.
#pragma once
#include <string>

#include "common/scene/reader.h"

namespace ballast::launch {

/// Reads the scene, makes its bodies, prints what it holds. Exit code.
int check(const std::string& scene, const Overrides& overrides);
/// Prints the effective scene, defaults written out.
int resolve(const std::string& scene, const Overrides& overrides);
/// Prints the JSON Schema of scene files.
int schema();
/// Prints which processes run, what is written, and what is left out and why.
int plan(const std::string& scene, const Overrides& overrides);

}  // namespace ballast::launch
