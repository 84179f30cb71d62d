// Fixed-point positions: each axis of the domain is divided into 2^32 quanta. Differences are exact integers (so
// precision does not depend on where the domain lies), and on a periodic axis wrap-around subtraction is the nearest
// image.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "common/scene/scene.h"

namespace ballast::fluid {

using Fixed3 = std::array<std::uint32_t, 3>;

/// The box that particles may be in, and the map between metres and quanta.
struct Coordinates {
  Box3 domain;  ///< m
  std::array<bool, 3> periodic{};
  Vec3 quantum = Vec3::Zero();  ///< m per quantum, per axis

  static Coordinates make(const Box3& domain, const std::array<bool, 3>& periodic) {
    Coordinates c{domain, periodic, (domain.max - domain.min) / 4294967296.0};
    return c;
  }
  /// True if the point can be represented; periodic axes wrap.
  bool holds(const Vec3& p) const {
    for (int k = 0; k < 3; ++k)
      if (!periodic[k] && !(p[k] >= domain.min[k] && p[k] < domain.max[k])) return false;
    return true;
  }
  /// True if the point lies in the box itself, also along periodic axes.
  bool inside(const Vec3& p) const {
    return ((p - domain.min).array() >= 0).all() && ((domain.max - p).array() > 0).all();
  }
  Fixed3 to_fixed(const Vec3& p) const {
    Fixed3 f;
    for (int k = 0; k < 3; ++k)
      f[k] = static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor((p[k] - domain.min[k]) / quantum[k])));
    return f;
  }
  Vec3 to_metres(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return {domain.min[0] + (x + 0.5) * quantum[0], domain.min[1] + (y + 0.5) * quantum[1],
            domain.min[2] + (z + 0.5) * quantum[2]};
  }
  /// a - b in metres, nearest image on periodic axes.
  Vec3 difference(const Fixed3& a, const Fixed3& b) const {
    Vec3 r;
    for (int k = 0; k < 3; ++k)
      r[k] = quantum[k] * static_cast<double>(periodic[k]
                                                  ? static_cast<std::int32_t>(a[k] - b[k])
                                                  : static_cast<std::int64_t>(a[k]) - static_cast<std::int64_t>(b[k]));
    return r;
  }
};

}  // namespace ballast::fluid
