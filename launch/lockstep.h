// The check that both processes speak of the same step and of the same bodies, on their step reports, and the balance
// of momentum between them.
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "common/exchange/link.h"
#include "common/result.h"

namespace ballast::launch {

/// |given - received| / scale, all in N s; nothing if they differ and there is no scale.
std::optional<double> momentum_imbalance(std::span<const double, 3> given, std::span<const double, 3> received,
                                         double scale);

/// Pairs the reports of the two processes in order. A difference in step or bodies hash is an error, code 5.
class Lockstep {
 public:
  explicit Lockstep(bool both) : both_(both) {}
  Status take(exchange::Role role, const exchange::StepReport& report);
  /// The run starts after this step.
  void go_on(std::uint64_t step) { reported_ = step; }
  /// Last step that every process of the run has reported.
  std::uint64_t reported() const { return reported_; }
  /// Of the momentum that the fluid gave the bodies and they received, up to that step; nothing with one process.
  std::optional<double> imbalance() const { return imbalance_; }

 private:
  bool both_;
  std::deque<exchange::StepReport> fluid_, rigid_;
  std::uint64_t reported_ = 0;
  std::optional<double> imbalance_;
};

}  // namespace ballast::launch
