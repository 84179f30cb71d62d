// Futex waiting in slices, each ending with a look at the processes that the run depends on.
#include "common/exchange/wait.h"

#include <algorithm>
#include <cstdio>

namespace ballast::exchange {
namespace {

double seconds_of(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

Waiter::Waiter(Segment::Impl& segment, Role self) : segment_(segment), self_(self), last_look_(Clock::now()) {}

// relaxed: a flag that is seen late costs its waker one needless system call
Waiter::~Waiter() { segment_.peer(self_).sleeping.store(0, std::memory_order_relaxed); }

Result<Waiter::End> Waiter::wait(const Word& word, std::uint32_t seen, Role awaited) {
  beat();
  // acquire: partner is the poster's store of the word; what it wrote before is now visible
  if (word.load(std::memory_order_acquire) != seen) return End::kChanged;
  const auto start = Clock::now();
  silence_ = 0;
  wait_start_ = start;
  last_beat_ = segment_.peer(awaited).heartbeat.load(std::memory_order_relaxed);
  ++waits_;
  auto end = sleep(word, seen, awaited);
  // Only the waiter writes its flag. relaxed: see ~Waiter; a later wait stores 1 after this in the same thread.
  segment_.peer(self_).sleeping.store(0, std::memory_order_relaxed);
  seconds_ += seconds_of(Clock::now() - start);
  return end;
}

Result<Waiter::End> Waiter::sleep(const Word& word, std::uint32_t seen, Role awaited) {
  // seq_cst pair with wake_if_sleeping(): we store the flag, then load the word; the poster stores the word, then loads
  // the flag. In the single order of these four, one of us sees the other; release and acquire alone allow neither.
  segment_.peer(self_).sleeping.store(1, std::memory_order_seq_cst);
  bool due = Clock::now() - last_look_ >= segment_.slice;
  for (;; due = true) {
    if (word.load(std::memory_order_seq_cst) != seen) return End::kChanged;
    if (due) {
      beat();
      auto state = look(awaited);
      // What a process posted before it ended is still delivered; its end will be noticed at the next wait.
      // acquire: as in wait()
      if (word.load(std::memory_order_acquire) != seen) return End::kChanged;
      if (!state) return state.error();
      if (*state == Look::kPeerFinished) return End::kPeerFinished;
    }
    const Woken woken = futex_wait(word, seen, segment_.slice);
    // The word moved and yet the whole slice was slept: a wake-up was lost, or came in the same instant.
    if (woken == Woken::kTimeout && word.load(std::memory_order_acquire) != seen) ++late_wakes_;
  }
}

Status Waiter::look_if_due() {
  beat();
  if (Clock::now() - last_look_ < segment_.slice) return ok();
  auto state = look(self_);
  if (!state) return state.error();
  return ok();
}

Result<Waiter::Look> Waiter::look(Role awaited) {
  const auto now = Clock::now();
  // Time in which this process was stopped itself (Ctrl-Z, debugger, suspended machine) is nobody's silence.
  const double awake = std::min(seconds_of(now - std::max(last_look_, wait_start_)), 2 * seconds_of(segment_.slice));
  last_look_ = now;
  Look result = Look::kGoOn;
  for (Role role : {Role::kFluid, Role::kRigid, Role::kCoordinator}) {
    if (role == self_ || !segment_.takes_part(role)) continue;
    auto one = look_at(role, role == awaited, awake);
    if (!one) return one.error();
    if (*one == Look::kPeerFinished) result = Look::kPeerFinished;
  }
  return result;
}

Result<Waiter::Look> Waiter::look_at(Role role, bool awaited, double awake) {
  const Header& header = segment_.header();
  const PeerLine& line = segment_.peer(role);
  if (awaited) silence_ += awake;
  // acquire, pid and state: partners are the stores in claim() and finish(), which come after what is read below
  const std::uint32_t pid = line.pid.load(std::memory_order_acquire);
  if (pid == 0) {
    if (!awaited) return Look::kGoOn;
    // acquire: partner is the fetch_or in Control::stop(); nothing else hangs on it
    const bool closed = (header.gate.load(std::memory_order_acquire) & kClosed) != 0;
    if (!closed && silence_ < header.peer_timeout) return Look::kGoOn;
    return complaint(role,
                     closed ? "had not attached when the run was stopped"
                            : "has not attached within " + number(header.peer_timeout) + " s",
                     "see whether it was started, and what it printed");
  }
  const auto finished = [&] {
    return line.state.load(std::memory_order_acquire) == static_cast<std::uint32_t>(Attendance::kFinished);
  };
  // It may finish and go between two looks: look for the process first, then once more at its state.
  const bool living = finished() || alive(pid, line.start_time.load(std::memory_order_relaxed));
  if (finished()) {
    const auto code = static_cast<std::int32_t>(line.exit_code.load(std::memory_order_relaxed));
    if (code == kFine) return awaited ? Look::kPeerFinished : Look::kGoOn;
    return complaint(role, "ended with exit code " + std::to_string(code), "its own message says why");
  }
  if (!living) {
    if (role == Role::kCoordinator) segment_.remove_if_orphaned();
    return complaint(role, "died", "see its last output, and the kernel's log (dmesg) for a kill for want of memory");
  }
  const std::uint64_t beat_seen = line.heartbeat.load(std::memory_order_relaxed);
  if (awaited && beat_seen != last_beat_) {
    last_beat_ = beat_seen;
    silence_ = 0;
  }
  if (awaited && silence_ >= header.peer_timeout) {
    return complaint(
        role, "is alive but has shown no sign of life for " + number(silence_) + " s",
        "it hangs or is stopped; if its steps really take that long, raise the time-out (ballast run --timeout)");
  }
  return Look::kGoOn;
}

Error Waiter::complaint(Role role, const std::string& what, const std::string& cure) const {
  const PeerLine& line = segment_.peer(role);
  const std::uint32_t pid = line.pid.load(std::memory_order_relaxed);
  std::string text = std::string("the ") + role_name(role);
  if (pid != 0) text += " (pid " + std::to_string(pid) + ")";
  text += " " + what;
  // The coordinator has no step of its own: name ours.
  const PeerLine& stepping = role == Role::kCoordinator ? segment_.peer(self_) : line;
  if (pid != 0) text += " during step " + std::to_string(stepping.step.load(std::memory_order_relaxed));
  return {text, cure, "", kProcessFailed};
}

}  // namespace ballast::exchange
