// Step reports of both processes compared pair by pair.
#include "launch/lockstep.h"

#include <fmt/format.h>

namespace ballast::launch {

using exchange::Role;
using exchange::StepReport;

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
  }
  return ok();
}

}  // namespace ballast::launch
