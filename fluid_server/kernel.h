// Smoothing kernels W(r) with support radius H, for numbers and for vectors alike.
//   cubic spline (Monaghan and Lattanzio 1985), h = H / 2, q = r / h:
//     W = s [ (2 - q)^3 / 4 - (1 - q)^3 ],  s = 10 / (7 pi h^2) in 2-D, 1 / (pi h^3) in 3-D, each bracket cut off at 0
//   Wendland C2 (Wendland 1995), q = r / H:
//     W = s (1 - q)^4 (1 + 4 q),            s = 7 / (pi H^2) in 2-D, 21 / (2 pi H^3) in 3-D
// Slopes are W' over the gradient that sums over the cubic lattice of the particles give (lattice_gradient).
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
  double lattice = 1;  ///< what slopes are divided by, see lattice_gradient()

  /// For particles that are spacing (m) apart; the support in spacings, 0: that of the kind.
  static Kernel of(KernelKind kind, int dimension, double spacing, double support = 0);

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
      return slope_scale() / (h() * rr) * (3 * b * b - 0.75 * a * a);
    }
    const double a = std::max(1 - r / support, 0.0);
    return -20 * slope_scale() / (support * support) * a * a * a;
  }
  double slope_scale() const { return scale() / lattice; }
};

/// Support radius in spacings. Wendland: README.md says why 2.9.
inline double support_in_spacings(KernelKind kind) { return kind == KernelKind::kCubic ? 2.0 : 2.9; }

/// Gradient of a field whose gradient is 1, by the sum over a cubic lattice: -1/D sum d^D r W'(r). Its Laplacian by the
/// viscous sum is wrong by the same factor.
inline double lattice_gradient(const Kernel& kernel, double spacing) {
  const int reach = static_cast<int>(kernel.support / spacing), deep = kernel.dimension == 3 ? reach : 0;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -deep; k <= deep; ++k) {
        const double r2 = spacing * spacing * (i * i + j * j + k * k);
        if (r2 > 0) sum -= r2 * kernel.slope_over_r(std::sqrt(r2));
      }
  return sum * std::pow(spacing, kernel.dimension) / kernel.dimension;
}

/// How fast pressure swings the particles of a cubic lattice about their places: a plane wave of displacements along an
/// axis has omega^2 = kappa p / (rho d^2) under a uniform pressure p, from the second derivatives of the sum of
/// 2 p V^2 W over the pairs. The largest kappa of all wave lengths; waves along other lines swing slower.
inline double lattice_stiffness(const Kernel& kernel, double spacing) {
  constexpr int kWaves = 64;
  constexpr double kNear = 1e-4;  // difference quotient of the slope
  const int reach = static_cast<int>(kernel.support / spacing), deep = kernel.dimension == 3 ? reach : 0;
  double largest = 0;
  for (int wave = 1; wave <= kWaves; ++wave) {
    double sum = 0;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -deep; k <= deep; ++k) {
          const double x = spacing * i, r = spacing * std::sqrt(i * i + j * j + k * k);
          if (r == 0) continue;
          const double change =
              (kernel.slope_over_r(r * (1 + kNear)) - kernel.slope_over_r(r * (1 - kNear))) / (2 * kNear);
          const double second = kernel.slope_over_r(r) + x * x / (r * r) * change;  // d^2 W / dx^2
          sum += second * (1 - std::cos(std::numbers::pi * wave / kWaves * i));
        }
    largest = std::max(largest, 2 * spacing * spacing * std::pow(spacing, kernel.dimension) * sum);
  }
  return largest;
}

/// Sum of W over a cubic lattice, over what it stands for: a particle of it has this summed density, not 1.
inline double lattice_density(const Kernel& kernel, double spacing) {
  const int reach = static_cast<int>(kernel.support / spacing), deep = kernel.dimension == 3 ? reach : 0;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -deep; k <= deep; ++k) sum += kernel.value(spacing * std::sqrt(double(i * i + j * j + k * k)));
  return sum * std::pow(spacing, kernel.dimension);
}

inline Kernel Kernel::of(KernelKind kind, int dimension, double spacing, double support) {
  Kernel kernel{kind, dimension, (support > 0 ? support : support_in_spacings(kind)) * spacing};
  kernel.lattice = lattice_gradient(kernel, spacing);
  return kernel;
}

}  // namespace ballast::fluid
