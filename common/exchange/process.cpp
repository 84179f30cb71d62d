// Reads /proc/<pid>/stat and calls futex(2), without allocating.
#include "common/exchange/process.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "common/result.h"

namespace ballast::exchange {

std::uint64_t start_time(std::uint32_t pid) {
  char path[32], text[1024];
  std::snprintf(path, sizeof path, "/proc/%u/stat", pid);
  const int file = ::open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  const ssize_t count = ::read(file, text, sizeof text - 1);
  ::close(file);
  if (count <= 0) return 0;
  text[count] = 0;
  // Field 2 is the program's name in parentheses and may itself hold blanks and parentheses: go on from the last one.
  const char* at = std::strrchr(text, ')');
  if (at == nullptr || at[1] == 0) return 0;
  at += 2;
  if (*at == 'Z' || *at == 'X') return 0;  // field 3: a zombie has died, its parent has just not looked yet
  for (int field = 3; field < 22; ++field) {
    at = std::strchr(at, ' ');
    if (at == nullptr) return 0;
    ++at;
  }
  return std::strtoull(at, nullptr, 10);
}

bool alive(std::uint32_t pid, std::uint64_t start) {
  const std::uint64_t now = start_time(pid);
  return now != 0 && (start == 0 || now == start);
}

namespace {

pid_t parent;
char last_words[160];

/// Only async-signal-safe calls. Any other SIGCONT finds the parent alive.
void on_continue(int) {
  if (::getppid() == parent) return;
  ::signal(SIGPIPE, SIG_IGN);  // who read our words may be gone, too
  [[maybe_unused]] const ssize_t written = ::write(2, last_words, std::strlen(last_words));
  ::_exit(kProcessFailed);
}

}  // namespace

void end_with_coordinator(const char* program) {
  int signal = 0;
  if (::prctl(PR_GET_PDEATHSIG, &signal) != 0 || signal != SIGCONT) return;
  parent = ::getppid();
  std::snprintf(last_words, sizeof last_words,
                "%s: the coordinator (pid %d) died without a word: the run ends here, its outputs are incomplete\n",
                program, static_cast<int>(parent));
  struct sigaction action {};
  action.sa_handler = on_continue;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGCONT, &action, nullptr);
  on_continue(0);
}

Woken futex_wait(const Word& word, std::uint32_t seen, std::chrono::nanoseconds at_most) {
  const auto ns = at_most.count();
  const timespec time{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
  const long result = ::syscall(SYS_futex, &word, FUTEX_WAIT, seen, &time, nullptr, 0);
  return result < 0 && errno == ETIMEDOUT ? Woken::kTimeout : Woken::kWake;
}

void futex_wake(const Word& word) { ::syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0); }

}  // namespace ballast::exchange
