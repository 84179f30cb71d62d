// How long the next step may be.
#include "fluid_server/step/step_control.h"

#include <cmath>

namespace ballast::fluid {

Step choose_step(const StepLimits& limits, const StepFacts& facts, double engine_bound, double time, double end) {
  Step step{limits.gravity_step, Limit::kGravity};
  if (!limits.implicit) step = {limits.courant * limits.h / (limits.sound_speed + facts.max_speed), Limit::kSound};
  const auto shorten = [&](double bound, Limit limit) {
    if (bound < step.dt) step = {bound, limit};
  };
  if (limits.kinematic_viscosity > 0) shorten(viscous_step(limits.h, limits.kinematic_viscosity), Limit::kViscosity);
  if (facts.drag_rate > 0) shorten(1 / facts.drag_rate, Limit::kViscosity);
  if (limits.implicit && facts.meeting_speed > 0)
    shorten(limits.longest_move * limits.spacing / facts.meeting_speed, Limit::kSpeed);
  if (limits.implicit) shorten(pressure_step(facts.lattice_rate), Limit::kPressure);
  if (!limits.implicit && facts.max_acceleration > 0)
    shorten(0.25 * std::sqrt(limits.h / facts.max_acceleration), Limit::kAcceleration);
  shorten(limits.staggered, Limit::kStaggered);
  shorten(engine_bound, Limit::kEngine);
  const double left = end - time;
  if (left <= step.dt) return {left, Limit::kOutput};
  if (left < 1.5 * step.dt) return {left / 2, Limit::kOutput};
  return step;
}

}  // namespace ballast::fluid
