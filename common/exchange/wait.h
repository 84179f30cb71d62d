// How a process sleeps until another one has moved a futex word, and how it learns that this will never happen.
#pragma once
#include <chrono>

#include "common/exchange/process.h"
#include "common/exchange/segment_impl.h"

namespace ballast::exchange {

class Waiter {
 public:
  Waiter(Segment::Impl& segment, Role self);
  ~Waiter();  ///< clears the sleeper flag

  enum class End { kChanged, kPeerFinished };
  /// Sleeps until `word` differs from `seen`. `awaited` is the process that has to move it: its silence is an error
  /// after peer_timeout, its clean end is kPeerFinished. The death of any process of the run is an error.
  Result<End> wait(const Word& word, std::uint32_t seen, Role awaited);
  /// Looks at the other processes if the last look is older than a slice; for calls that seldom sleep.
  Status look_if_due();
  /// Sign of life for those who wait for us.
  void beat() {
    PeerLine& self = segment_.peer(self_);
    // relaxed, here and at its reader: it orders nothing, only the fact that it changes counts; we are its only writer
    self.heartbeat.store(self.heartbeat.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }
  /// Step begun last, for the messages of others.
  void note_step(std::uint64_t step) { segment_.peer(self_).step.store(step, std::memory_order_relaxed); }

  double seconds() const { return seconds_; }
  std::uint64_t waits() const { return waits_; }
  std::uint64_t late_wakes() const { return late_wakes_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Look { kGoOn, kPeerFinished };
  Result<End> sleep(const Word& word, std::uint32_t seen, Role awaited);
  Result<Look> look(Role awaited);
  Result<Look> look_at(Role role, bool awaited, double awake);
  Error complaint(Role role, const std::string& what, const std::string& cure) const;

  Segment::Impl& segment_;
  Role self_;
  Clock::time_point last_look_, wait_start_{};
  double silence_ = 0;           ///< s in this wait without a sign of life of the awaited process
  std::uint64_t last_beat_ = 0;  ///< its heartbeat at the last look
  double seconds_ = 0;
  std::uint64_t waits_ = 0, late_wakes_ = 0;
};

}  // namespace ballast::exchange
