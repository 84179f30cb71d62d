// Running the program povray.
#pragma once
#include <string>

#include "common/result.h"

namespace ballast::output {

/// Renders `pov` to `png`, 1280 x 720. Error: povray missing (with how to install it) or its last message.
Status run_povray(const std::string& pov, const std::string& png, int threads);

}  // namespace ballast::output
