// Step reports of both processes compared pair by pair.
#include "launch/lockstep.h"

#include <fmt/format.h>

#include <cmath>

namespace ballast::launch {

using exchange::Role;
using exchange::StepReport;

std::optional<double> momentum_imbalance(std::span<const double, 3> given, std::span<const double, 3> received,
                                         double scale) {
  double difference = 0;
  for (std::size_t k = 0; k < 3; ++k) difference = std::hypot(difference, given[k] - received[k]);
  if (difference == 0) return 0.0;
  return scale > 0 ? difference / scale : std::optional<double>();
}

Status Lockstep::take(Role role, const StepReport& report) {
  if (!both_) {
    reported_ = report.step;
    return ok();
  }
  (role == Role::kFluid ? fluid_ : rigid_).push_back(report);
  while (!fluid_.empty() && !rigid_.empty()) {
    const StepReport f = fluid_.front(), r = rigid_.front();
    fluid_.pop_front();
    rigid_.pop_front();
    // Repeated iterations are not compared: each side reports a step once, when it can no longer be taken back.
    if (f.step != r.step) {
      return Error{fmt::format("the processes are out of step: the fluid reports step {}, the rigid process step {}",
                               f.step, r.step),
                   "a defect of one of the two processes: run again with --engine free_body to see which", "",
                   kProcessFailed};
    }
    if (f.hash != r.hash) {
      return Error{
          fmt::format(
              "the processes disagree on the bodies at step {} (t = {:.6g} s): fluid has hash {:016x}, rigid {:016x}",
              f.step, r.time, f.hash, r.hash),
          "a defect of one of the two processes: run again with --engine free_body to see which", "", kProcessFailed};
    }
    reported_ = f.step;
    imbalance_ = momentum_imbalance(f.impulse, r.impulse, f.impulse_scale);
  }
  return ok();
}

}  // namespace ballast::launch
