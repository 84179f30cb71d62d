// What the fluid process tells monitors beside its reports: statistics, contacts, some of the particles.
#pragma once
#include <chrono>
#include <span>
#include <vector>

#include "common/exchange/link.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

/// Exists only in runs whose segment says that a monitor wants frames of the fluid. It changes nothing that a step
/// takes from the last one, and its frames never wait for room, so neither result nor speed depends on who watches.
class MonitorFrames {
 public:
  static bool wanted(const exchange::Segment& segment);
  MonitorFrames(const exchange::Segment& segment, const Scene& scene, WcsphFluid& fluid);

  /// Offers the frames wanted of this moment; nothing if the last ones are less than 50 ms of wall time old, more than
  /// a person sees: a scene that runs faster than real time would fill the ring with rows that nobody can follow.
  /// `measures` are the last taken, `before` the states at the beginning of the last step that was computed; none
  /// before the first.
  void offer(exchange::Link& link, std::uint64_t step, double time, Limit limit, const Measures& measures,
             std::span<const exchange::BodyState> before);

 private:
  void offer_statistics(exchange::Link& link, std::uint64_t step, double time, Limit limit, const Measures& measures);
  void offer_particles(exchange::Link& link, std::uint64_t step, double time);

  using Clock = std::chrono::steady_clock;
  WcsphFluid& fluid_;
  bool contacts_;
  std::size_t most_particles_;  // in a frame; 0: none
  Clock::time_point next_{};
  std::vector<std::byte> buffer_;
};

}  // namespace ballast::fluid
