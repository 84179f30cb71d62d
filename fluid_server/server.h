// The fluid process: the loop of exchange steps, no physics.
#pragma once
#include <string>

#include "common/exchange/link.h"
#include "common/result.h"

namespace ballast::fluid {

/// Runs the scene in the segment to its end. The exit code, and the error if it is not kFine.
Status serve(exchange::Segment& segment);

}  // namespace ballast::fluid
