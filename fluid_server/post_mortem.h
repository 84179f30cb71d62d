// What is said about a run that diverged: when, where, which limit was crossed, who was near, and what to try.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

inline constexpr double kMostCompression = 0.1;  ///< mean density error beyond which a run has diverged
inline constexpr double kMostMach = 20;          ///< and largest speed, sound speeds

/// The step that the run ended with.
struct LastStep {
  std::uint64_t number = 0;
  double time = 0, dt = 0;         ///< s, at its end
  double largest_mach_before = 0;  ///< largest speed over sound speed of any step before it
  double compression_mean = 0;     ///< as measured last
  double energy_gain = 0;          ///< J, as measured last
  double energy_share = 0;         ///< of the energy at play
};

/// The error (exit code 4). Names the fastest particles, the nearest body, and the likely cause: a step longer than the
/// scheme bears, a sound speed below the flow's, the staggered scheme with a light body. Report::write_post_mortem()
/// writes the state.
Error post_mortem(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid,
                  std::span<const exchange::BodyState> states, const LastStep& step);

}  // namespace ballast::fluid
