// When a run has come to rest and nothing is about to disturb it: steps may then be slept through, with every particle
// and body frozen where it is. Decided from what both processes know, so that it is the same with any number of
// threads, in a resumed run and in a replay.
#pragma once
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/exchange/manifest.h"

namespace ballast::exchange {

class Sleep {
 public:
  explicit Sleep(const ManifestView& manifest);

  /// The world has been asked to sleep, and nothing keeps it awake for ever.
  bool possible() const { return speed_ > 0 && awake_because_.empty(); }
  /// Who keeps it awake for ever, although it was asked to sleep; else empty.
  const std::string& awake_because() const { return awake_because_; }
  double speed() const { return speed_; }  ///< m/s, below which it is at rest
  double after() const { return after_; }  ///< s at rest before it sleeps

  /// Asleep from `time` on, up to this time at most: the next row or prescribed motion. `time`: awake.
  double until(double time) const;
  /// Books the end, at `time`, of a step that was computed. `others`: fastest of what is no body, m/s.
  void computed(double time, std::span<const BodyState> states, double others);
  /// Books the end, at `time`, of a step slept through that began at `begin`.
  void slept(double begin, double time);
  /// Wall time that the last step took, s; its length was dt.
  void took(double wall, double dt);
  /// A command takes effect at `time`: it wakes.
  void command(const Command& command, double time);

  /// One uninterrupted sleep.
  struct Nap {
    double from, to;  ///< s
    double speed;     ///< of the fastest point when it began, m/s
  };
  const std::vector<Nap>& naps() const { return naps_; }
  std::uint64_t steps() const { return steps_; }  ///< slept through
  double seconds() const;                         ///< of simulated time slept through
  /// Furthest that anything could have moved meanwhile without being faster than speed(), m.
  double bound() const { return speed_ * seconds(); }
  /// The same at the speed that the fastest had when it fell asleep: m.
  double drift() const;

  /// Wall time that the steps slept through would have taken at the mean pace of those computed, less what they took,
  /// s; in a resumed run since it was resumed.
  double saved() const;
  /// Wall time that looking for rest took, s; since resumed, too.
  double watched() const { return watched_; }

  /// For checkpoints (common/checkpoint/state.h).
  template <class A>
  void state(A& a) {
    a("quiet_since", quiet_since_), a("pushed_until", pushed_until_), a("fastest", fastest_);
    a("asleep", asleep_), a("naps", naps_), a("steps", steps_);
  }

 private:
  /// Prescribed body that moves between two times.
  struct Drive {
    double start, stop;  ///< s
  };
  double speed_, after_, output_every_;
  std::string awake_because_;
  std::vector<double> reach_;  // by body: of its furthest point from its frame's origin, m
  std::vector<Drive> drives_;
  double quiet_since_ = 0, pushed_until_ = 0;  // s
  double fastest_ = std::numeric_limits<double>::infinity();
  bool asleep_ = false;
  std::vector<Nap> naps_;
  std::uint64_t steps_ = 0;
  double computed_wall_ = 0, computed_time_ = 0, slept_wall_ = 0, slept_time_ = 0;  // s
  mutable double watched_ = 0;  // s; measured, and nothing hangs on it
};

}  // namespace ballast::exchange
