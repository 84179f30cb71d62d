// What the accuracy classes of a scene (world.accuracy) set, for both solvers. README.md has what was measured.
#pragma once
#include "common/scene/scene.h"

namespace ballast::fluid {

struct AccuracyClass {
  double courant;              ///< explicit: of h / (c + v), the step
  double longest_move;         ///< implicit: of particles against what is around them in a step, spacings
  double gravity_share;        ///< implicit: of sqrt(d / |G|), the step
  double tolerance;            ///< implicit: mean density error that a step may leave, of gravity_share^2
  double body_tolerance;       ///< implicit: change of a body's acceleration, of max(|a|, |G|) ...
  std::size_t body_products;   ///< ... over this many products
  double interface_tolerance;  ///< iterated scheme: interface residual that a step may leave, relative
  bool brief_in_3d;            ///< 3-D: cubic spline with support 2 d, implicit Wendland C2 with 2.1 d; else with 2.9 d
};

constexpr AccuracyClass settings_of(Accuracy accuracy) {
  switch (accuracy) {
    case Accuracy::kInteractive:
      return {0.6, 0.5, 0.2, 2e-3, 1e-1, 2, 3e-2, true};
    case Accuracy::kBalanced:
      return {0.5, 0.4, 0.1, 1e-3, 1e-3, 5, 1e-2, false};
    case Accuracy::kAccurate:
      break;
  }
  return {0.25, 0.4, 0.05, 1e-3, 1e-3, 5, 1e-3, false};
}

}  // namespace ballast::fluid
