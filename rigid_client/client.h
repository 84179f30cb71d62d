// The rigid process: takes orders from the fluid, steps the engine, answers; or runs alone where there is no fluid.
#pragma once
#include <string>

#include "common/exchange/link.h"
#include "common/result.h"

namespace ballast::rigid {

/// Runs the named engine on the segment's manifest until the run ends; hands over the final report in any case.
Status serve(exchange::Segment& segment, const std::string& engine_name);

}  // namespace ballast::rigid
