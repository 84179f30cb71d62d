// How long the next step may be, and why.
#pragma once
#include <array>
#include <cstdint>

#include "common/exchange/records.h"
#include "common/scene/scene.h"

namespace ballast::fluid {

/// What the present state says about the next step.
struct StepFacts {
  double max_speed = 0;         ///< of particles and samples, m/s
  double meeting_speed = 0;     ///< the same against what is around them (meeting_speed.h); explicit: max_speed
  double max_acceleration = 0;  ///< of particles, m/s^2
  double max_move = 0;          ///< in the step just done, at that speed, spacings
  double way = 0;               ///< of that in all steps
  double lattice_rate = 0;      ///< implicit: at which pressure swings particles about their places, 1/s
  double drag_rate = 0;         ///< at which viscosity slows the lightest body, 1/s; 0 where it cannot matter
  bool finite = true;           ///< no NaN anywhere
};

enum class Limit : std::uint32_t {
  kSound,
  kViscosity,
  kAcceleration,
  kStaggered,
  kEngine,
  kOutput,
  kRetry,
  kSpeed,
  kGravity,
  kAsleep,
  kPressure,
  kCount
};
inline constexpr auto& kLimitNames = exchange::kStepLimits;
static_assert(kLimitNames.size() == static_cast<std::size_t>(Limit::kCount));

/// Farthest that an implicit fluid moves in a step where particles are shifted, spacings: shifting, itself bound to a
/// share of a spacing a step, has to keep up with the shear.
inline constexpr double kLongestShiftedMove = 0.06;
/// How much farther than foretold it may turn out to move before the step is done again.
inline constexpr double kBeyondForetold = 1.25;

struct StepLimits {
  bool implicit = false;           ///< the two below rule instead of sound and acceleration
  double spacing = 0;              ///< d, m
  double longest_move = 0.4;       ///< that a step is chosen for, spacings
  double most_move = 0.5;          ///< beyond which a step is done again, spacings
  double gravity_step = 1e300;     ///< s
  double h = 0;                    ///< smoothing length (half the support), m
  double sound_speed = 0;          ///< m/s
  double courant = 0.25;           ///< of h / (c + v)
  double kinematic_viscosity = 0;  ///< largest, m^2/s
  double staggered = 1e300;        ///< s, bound of the staggered scheme
};

struct Step {
  double dt = 0;
  Limit limit = Limit::kSound;
};

/// Longest step of the viscous forces between particles, s.
inline double viscous_step(double h, double kinematic_viscosity) { return h * h / (8 * kinematic_viscosity); }

/// Longest step in which the particles of an implicit fluid keep their places under the pressure that they bear: no
/// solve holds a lattice's own waves, and symplectic Euler lets those grow whose omega is above 2 / dt.
inline double pressure_step(double lattice_rate) {
  constexpr double kSafe = 0.9;
  return lattice_rate > 0 ? 2 * kSafe / lattice_rate : 1e300;
}

/// Shortest of: courant h / (c + v); h^2 / (8 nu) and 1 / drag_rate; sqrt(h / a) / 4 (Monaghan 1992); the engine's
/// bound; what is left to `end`. An implicit fluid has no sound: longest_move d / (meeting speed) and gravity_step in
/// the place of the first and third, and pressure_step. A step that would leave less than half a step is stretched over
/// what is left.
Step choose_step(const StepLimits& limits, const StepFacts& facts, double engine_bound, double time, double end);

}  // namespace ballast::fluid
