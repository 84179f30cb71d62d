// What the two processes disagree about in a step: the fluid moved every body with an acceleration that it foresaw, the
// engine then found one. Where nothing but the fluid and gravity acts they are the same; where a joint or a contact
// bears something new, they are not. Here that residual is measured and, by the iterated scheme, brought down.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/exchange/records.h"
#include "common/geometry/bodies.h"
#include "fluid_server/step/quasi_newton.h"

namespace ballast::fluid {

/// Sums over the steps that were kept.
struct InterfaceReport {
  std::uint64_t steps = 0;             ///< in which a body that moves freely was wet
  double sum = 0, most = 0, last = 0;  ///< residual of a step, relative: that of its worst body
  std::uint64_t iterations = 0;        ///< exchanges in those steps: one each, and the repetitions
  std::uint64_t most_iterations = 0;
  std::uint64_t unreached = 0;  ///< steps whose residual stayed above the tolerance
};

class Interface {
 public:
  /// `foresees`: the fluid takes free acceleration + mobility * wrench, else (staggered scheme) the last acceleration.
  Interface(const Scene& scene, std::span<const Body> bodies, bool foresees);

  void set_gravity(const Vec3& gravity) { gravity_ = gravity.norm(); }  ///< m/s^2

  /// A step begins, or a try of it, from these states. `at_start`: it is repeated by any scheme that foresees, since
  /// nobody knows yet what contacts bear.
  void begin(std::span<const exchange::BodyState> states, bool at_start = false);
  /// States that the fluid reckons with: those of begin(), the free acceleration replaced in repetitions.
  std::span<const exchange::BodyState> assumed() const { return assumed_; }
  /// What one exchange gave. True if the step can be kept: the residual is below the tolerance, or no further
  /// repetition is wanted; else assumed() holds what to repeat the step with.
  bool settle(std::span<const exchange::Wrench> wrenches, std::span<const exchange::BodyState> after);
  /// Books the step.
  void keep();

  bool iterates() const { return iterates_; }
  bool may_repeat() const { return may_repeat_; }  ///< the step at hand
  double tolerance() const { return tolerance_; }  ///< relative
  int most_iterations() const { return most_iterations_; }
  const InterfaceReport& report() const { return report_; }

  template <class A>
  void state(A& a) {
    a("report", report_);
  }

 private:
  double measure(std::span<const exchange::Wrench> wrenches, std::span<const exchange::BodyState> after);

  bool foresees_, iterates_, may_repeat_ = false;
  double tolerance_;
  int most_iterations_;
  double gravity_;                 // m/s^2
  std::vector<double> displaced_;  // fluid mass in the place of each body, kg
  std::vector<exchange::BodyState> assumed_;
  std::vector<double> turning_;  // radius of gyration of each body, m: what makes angular accelerations comparable
  Eigen::VectorXd residual_;     // m/s^2, six numbers a body
  int iteration_ = 0;
  bool wet_ = false;
  double relative_ = 0;
  QuasiNewton solver_;
  InterfaceReport report_;
};

}  // namespace ballast::fluid
