// How far the particles of a fluid reach.
#pragma once
#include "fluid_server/particles/coordinates.h"
#include "fluid_server/particles/particles.h"

namespace ballast::fluid {

/// Lengths of the box around all of them, m, world axes.
inline Vec3 extent_of(const Particles& particles, const Coordinates& coordinates) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const Record& r : particles.record) {
    const Vec3 p = coordinates.to_metres(r.x, r.y, r.z);
    low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  return high - low;
}

}  // namespace ballast::fluid
