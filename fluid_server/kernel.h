// Smoothing kernels W(r) with support radius H, for numbers and for vectors alike.
//   cubic spline (Monaghan and Lattanzio 1985), h = H / 2, q = r / h:
//     W = s [ (2 - q)^3 / 4 - (1 - q)^3 ],  s = 10 / (7 pi h^2) in 2-D, 1 / (pi h^3) in 3-D, each bracket cut off at 0
//   Wendland C2 (Wendland 1995), q = r / H:
//     W = s (1 - q)^4 (1 + 4 q),            s = 7 / (pi H^2) in 2-D, 21 / (2 pi H^3) in 3-D
#pragma once
#include <cmath>
#include <numbers>

#include "common/scene/scene.h"

namespace ballast::fluid {

/// Constants of a kernel for one dimension and support.
struct Kernel {
  KernelKind kind = KernelKind::kWendland;
  int dimension = 3;
  double support = 0;  ///< H, m

  double h() const { return support / 2; }
  double scale() const {
    const double pi = std::numbers::pi, H = support, hh = h();
    if (kind == KernelKind::kCubic) return dimension == 2 ? 10 / (7 * pi * hh * hh) : 1 / (pi * hh * hh * hh);
    return dimension == 2 ? 7 / (pi * H * H) : 21 / (2 * pi * H * H * H);
  }
  /// W at distance r, 1/m^dimension.
  double value(double r) const {
    if (kind == KernelKind::kCubic) {
      const double q = r / h(), a = std::max(2 - q, 0.0), b = std::max(1 - q, 0.0);
      return scale() * (0.25 * a * a * a - b * b * b);
    }
    const double q = r / support, a = std::max(1 - q, 0.0);
    return scale() * a * a * a * a * (1 + 4 * q);
  }
  /// W'(r) / r: grad W = (W'/r) times the vector to the particle, 1/m^(dimension + 2).
  double slope_over_r(double r) const {
    if (kind == KernelKind::kCubic) {
      const double rr = std::max(r, 1e-9 * support), q = rr / h(), a = std::max(2 - q, 0.0), b = std::max(1 - q, 0.0);
      return scale() / (h() * rr) * (3 * b * b - 0.75 * a * a);
    }
    const double a = std::max(1 - r / support, 0.0);
    return -20 * scale() / (support * support) * a * a * a;
  }
};

/// Support radius in spacings. Wendland: README.md says why 2.9.
inline double support_in_spacings(KernelKind kind) { return kind == KernelKind::kCubic ? 2.0 : 2.9; }

}  // namespace ballast::fluid
