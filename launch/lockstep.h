// The check that both processes speak of the same step and of the same bodies, on their step reports.
#pragma once
#include <cstdint>
#include <deque>

#include "common/exchange/link.h"
#include "common/result.h"

namespace ballast::launch {

/// Pairs the reports of the two processes in order. A difference in step or bodies hash is an error, code 5.
class Lockstep {
 public:
  explicit Lockstep(bool both) : both_(both) {}
  Status take(exchange::Role role, const exchange::StepReport& report);
  /// The run starts after this step.
  void go_on(std::uint64_t step) { reported_ = step; }
  /// Last step that every process of the run has reported.
  std::uint64_t reported() const { return reported_; }

 private:
  bool both_;
  std::deque<exchange::StepReport> fluid_, rigid_;
  std::uint64_t reported_ = 0;
};

}  // namespace ballast::launch
