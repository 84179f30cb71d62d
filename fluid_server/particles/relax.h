// Relaxing the start: cutting a lattice along a curved surface leaves holes and overlaps that cost most of the added
// mass; some hundred small moves down the gradient of the summed density close them.
#pragma once
#include <functional>
#include <span>

#include "fluid_server/neighbours/neighbourhood.h"
#include "fluid_server/passes/passes.h"

namespace ballast::fluid {

struct RelaxReport {
  int moves = 0;             ///< rounds done
  bool settled = true;       ///< false: ended by the number of rounds
  double spread_before = 0;  ///< standard deviation of the summed density over 1, particles away from the free surface
  double spread_after = 0;
  double last_move = 0;  ///< largest move of the last round, spacings
};

/// Moves the particles by -0.2 d^2 sum V grad W and 0.8 of their last move, at most 0.1 d a round, until the largest
/// move is below 5e-4 d, the spread of the summed density falls by less than 5 % in 50 rounds, or after `at_most`
/// rounds; gives a sign of life in each. `shifting`: along the push of Unevenness instead, so that particle shifting
/// has nothing to do at the start. `solid` are all samples and the ghosts that hold the free surface.
RelaxReport relax(
    Particles& particles, std::span<const Record> solid, const Coordinates& coordinates, const PassConstants& constants,
    double spacing, bool shifting, int at_most, const std::function<void()>& sign_of_life = [] {});

}  // namespace ballast::fluid
