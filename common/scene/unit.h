// Numbers with units: "5 cm", "1000 kg/m^3", "4 %" -> SI, checked for dimension.
#pragma once
#include <string>
#include <string_view>

#include "common/result.h"

namespace ballast::scene {

/// Exponents of m, kg, s and rad. Angles count as a dimension so that "N m" and "N m/rad" are told apart.
struct Dims {
  int length = 0, mass = 0, time = 0, angle = 0;
  bool operator==(const Dims&) const = default;
};

/// What a number means: name and SI unit for messages, dimension for the check.
struct Quantity {
  const char* name = "plain number";
  const char* unit = "";
  Dims dims;
  bool any = false;  ///< takes every unit (columns whose meaning is not known here)
  /// Magnitudes beyond which a value is a slip of the hand, not physics: SI; `least` is for values that must not be 0.
  double least = 1e-30, most = 1e30;
};

inline constexpr Quantity kNone{};
inline constexpr Quantity kLength{"length", "m", {1, 0, 0, 0}, false, 1e-09, 1e+06};
inline constexpr Quantity kMass{"mass", "kg", {0, 1, 0, 0}, false, 1e-15, 1e+15};
inline constexpr Quantity kTime{"time", "s", {0, 0, 1, 0}, false, 1e-09, 1e+09};
inline constexpr Quantity kAngle{"angle", "rad", {0, 0, 0, 1}, false, 1e-30, 1e+06};
inline constexpr Quantity kFrequency{"frequency", "Hz", {0, 0, -1, 0}, false, 1e-30, 1e+09};
inline constexpr Quantity kSpeed{"speed", "m/s", {1, 0, -1, 0}, false, 1e-30, 1e+06};
inline constexpr Quantity kAngularSpeed{"angular velocity", "rad/s", {0, 0, -1, 1}, false, 1e-30, 1e+06};
inline constexpr Quantity kAcceleration{"acceleration", "m/s^2", {1, 0, -2, 0}, false, 1e-30, 1e+06};
inline constexpr Quantity kDensity{"density", "kg/m^3", {-3, 1, 0, 0}, false, 1e-06, 1e+06};
inline constexpr Quantity kViscosity{"dynamic viscosity", "Pa s", {-1, 1, -1, 0}, false, 1e-30, 1e+09};
inline constexpr Quantity kSurfaceTension{"surface tension", "N/m", {0, 1, -2, 0}, false, 1e-30, 1e+06};
inline constexpr Quantity kPressureUnit{"pressure", "Pa", {-1, 1, -2, 0}, false, 1e-30, 1e+15};
inline constexpr Quantity kForceUnit{"force", "N", {1, 1, -2, 0}, false, 1e-30, 1e+18};
inline constexpr Quantity kTorque{"torque", "N m", {2, 1, -2, 0}, false, 1e-30, 1e+18};
inline constexpr Quantity kStiffness{"stiffness", "N/m", {0, 1, -2, 0}, false, 1e-30, 1e+18};
inline constexpr Quantity kAngularStiffness{"angular stiffness", "N m/rad", {2, 1, -2, -1}, false, 1e-30, 1e+18};
inline constexpr Quantity kDamping{"damping", "N s/m", {0, 1, -1, 0}, false, 1e-30, 1e+18};
inline constexpr Quantity kAngularDamping{"angular damping", "N m s/rad", {2, 1, -1, -1}, false, 1e-30, 1e+18};
inline constexpr Quantity kAnyQuantity{"number", "SI", {}, true};

/// A number as written, converted to SI.
struct Measure {
  double value = 0;
  bool percent = false;  ///< written with %
};

/// Reads `text` as a `quantity`. A number without unit is SI. `spacing` (m) is what "spacings" stands for; 0: not
/// known. Errors carry no place; the caller adds it.
Result<Measure> parse_measure(std::string_view text, const Quantity& quantity, double spacing);

/// A whole number, without unit.
Result<long long> parse_integer(std::string_view text);

}  // namespace ballast::scene
