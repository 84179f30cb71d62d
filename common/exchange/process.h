// What the kernel knows about processes: their start time, whether they live, and futex waiting between them.
#pragma once
#include <chrono>
#include <cstdint>

#include "common/exchange/layout.h"

namespace ballast::exchange {

/// Start time of a process in clock ticks since boot (field 22 of /proc/<pid>/stat); 0 if there is no such process, or
/// only its zombie is left.
std::uint64_t start_time(std::uint32_t pid);
/// The process with this pid and start time still runs. start = 0: any start time (the process is just registering).
bool alive(std::uint32_t pid, std::uint64_t start);

/// For a process that asked the kernel for SIGCONT when its parent dies (prctl PR_SET_PDEATHSIG), as the coordinator's
/// children do: from now on it says so then, as `program`, and ends with code 5, also out of a stop. Does nothing in a
/// process that was started otherwise. Once in a process.
void end_with_coordinator(const char* program);

enum class Woken { kWake, kTimeout };
/// Sleeps while word == seen, until woken, interrupted or for at_most. Works between processes (no FUTEX_PRIVATE).
Woken futex_wait(const Word& word, std::uint32_t seen, std::chrono::nanoseconds at_most);
/// Wakes all that sleep on this word.
void futex_wake(const Word& word);

/// The waker's half of the handshake that README.md calls "post and wake". The caller has just changed `word` with a
/// sequentially consistent operation; this load is the second of the pair: it partners Waiter::wait, which stores the
/// flag and then loads the word. In the single total order either we see the flag, or the waiter sees our word.
inline void wake_if_sleeping(const Word& word, const PeerLine& waiter) {
  if (waiter.sleeping.load(std::memory_order_seq_cst) != 0) futex_wake(word);
}

}  // namespace ballast::exchange
