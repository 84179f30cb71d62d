// When rows and checkpoints are due.
#pragma once
#include <cmath>
#include <cstdint>

namespace ballast {

/// Whole intervals of `every` s (> 0) that have passed at `time`. Processes that ask with the same time agree; a time
/// that rounding left a hair below a multiple counts as that.
inline std::int64_t intervals_passed(double time, double every) {
  return static_cast<std::int64_t>(std::floor(time / every + 1e-9));
}

}  // namespace ballast
