// The interface residual, and the repetition of steps that brings it down.
//
// Unknowns x: the free accelerations a0 that the fluid reckons with, six a body. The fluid answers with wrenches w(x)
// and has foreseen x + K w; the engine finds a. What joints and contacts bore is H(x) = a - K w, and x = H(x) where
// both agree: the residual of this fixed point, H(x) - x, is what the two disagree about. A body on which they bear
// nothing has a constant H, so that it costs no repetition, however light it is.
#include "fluid_server/step/interface.h"

#include <algorithm>
#include <cmath>

#include "fluid_server/boundary/samples.h"
#include "fluid_server/step/accuracy.h"

namespace ballast::fluid {

namespace {

using Eigen::Index;

/// From the mobility of a free body, whatever engine posted it: sqrt(mean 1/m over mean 1/I).
double radius_of_gyration(const exchange::BodyState& state) {
  const auto mobility = mobility_of(state);
  const auto mean = [](const Vec3& diagonal) {
    const auto axes = (diagonal.array() > 0).count();
    return axes > 0 ? diagonal.sum() / static_cast<double>(axes) : 0.0;
  };
  const double linear = mean(mobility.diagonal().head<3>()), angular = mean(mobility.diagonal().tail<3>());
  return angular > 0 ? std::sqrt(linear / angular) : 0;
}

}  // namespace

Interface::Interface(const Scene& scene, std::span<const Body> bodies, bool foresees)
    : foresees_(foresees),
      iterates_(scene.coupling.scheme == "iterated"),
      tolerance_(scene.coupling.tolerance > 0 ? scene.coupling.tolerance
                                              : settings_of(scene.world.accuracy).interface_tolerance),
      most_iterations_(scene.coupling.most_iterations),
      gravity_(scene.world.gravity.norm()),
      turning_(bodies.size()),
      residual_(6 * static_cast<Index>(bodies.size())) {
  double density = 0;
  for (const Fluid& fluid : scene.fluids) density = std::max(density, fluid.density);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    displaced_.push_back(scene.models[b].motion == Motion::kDynamic ? density * bodies[b].solid.mass_properties().volume
                                                                    : 0);
}

void Interface::begin(std::span<const exchange::BodyState> states, bool at_start) {
  may_repeat_ = iterates_ || (at_start && foresees_);
  assumed_.assign(states.begin(), states.end());
  // For dry bodies, too: one that becomes wet in a repetition must not find the scale of an earlier step, or none.
  for (std::size_t b = 0; b < states.size(); ++b) turning_[b] = radius_of_gyration(states[b]);
  iteration_ = 0;
  solver_.begin();
}

double Interface::measure(std::span<const exchange::Wrench> wrenches, std::span<const exchange::BodyState> after) {
  wet_ = false;
  residual_.setZero();
  double worst = 0;
  for (std::size_t b = 0; b < assumed_.size(); ++b) {
    Vector6 wrench;
    wrench << Vec3::Map(wrenches[b].force), Vec3::Map(wrenches[b].torque);
    const auto mobility = mobility_of(assumed_[b]);
    if (wrench.isZero(0) || mobility.isZero(0)) continue;
    wet_ = true;
    const Vector6 found = Vector6::Map(after[b].acceleration);
    const Vector6 foreseen = foresees_ ? Vector6(Vector6::Map(assumed_[b].free_acceleration) + mobility * wrench)
                                       : Vector6(Vector6::Map(assumed_[b].acceleration));
    auto residual = residual_.segment<6>(6 * static_cast<Index>(b));
    residual = found - foreseen;
    residual.tail<3>() *= turning_[b];
    // What an acceleration is compared with: gravity, the body's own, and what the force on it would give to the fluid
    // in its place; what it would give to a light body itself would be far more than matters.
    const double fluid = displaced_[b] > 0 ? wrench.head<3>().norm() / displaced_[b] : 0;
    const double scale = std::max({gravity_, found.head<3>().norm(), fluid});
    if (scale > 0) worst = std::max(worst, residual.norm() / scale);
  }
  return worst;
}

bool Interface::settle(std::span<const exchange::Wrench> wrenches, std::span<const exchange::BodyState> after) {
  relative_ = measure(wrenches, after);
  ++iteration_;
  if (!may_repeat_ || !wet_ || relative_ <= tolerance_ || iteration_ >= most_iterations_) return true;
  Eigen::VectorXd x(residual_.size());
  const auto at = [&](std::size_t b) { return x.segment<6>(6 * static_cast<Index>(b)); };
  for (std::size_t b = 0; b < assumed_.size(); ++b) {
    at(b) = Vector6::Map(assumed_[b].free_acceleration);
    at(b).tail<3>() *= turning_[b];
  }
  x = solver_.next(x, residual_);
  for (std::size_t b = 0; b < assumed_.size(); ++b) {
    if (residual_.segment<6>(6 * static_cast<Index>(b)).isZero(0)) continue;
    if (turning_[b] > 0) at(b).tail<3>() /= turning_[b];
    Vector6::Map(assumed_[b].free_acceleration) = at(b);
  }
  return false;
}

void Interface::keep() {
  report_.last = wet_ ? relative_ : 0;
  if (!wet_) return;
  ++report_.steps;
  report_.sum += relative_;
  report_.most = std::max(report_.most, relative_);
  report_.iterations += static_cast<std::uint64_t>(iteration_);
  report_.most_iterations = std::max(report_.most_iterations, static_cast<std::uint64_t>(iteration_));
  report_.unreached += may_repeat_ && relative_ > tolerance_;
}

}  // namespace ballast::fluid
