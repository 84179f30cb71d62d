// What a step's exchange costs, beside what the machine can do: cache-line ping-pong, kernel futex round trip, and
// Ballast's round trip of 32 bodies with every number checked. All in one run, interleaved, since machines are noisy.
#include <linux/futex.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/exchange/link.h"

namespace {

using namespace ballast::exchange;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kBodies = 32;

/// On which processors the two processes run; negative: where the kernel likes.
struct Placement {
  const char* name;
  int first, second;
};
constexpr Placement kApart{"two cores", 0, 1}, kFree{"not pinned", -1, -1}, kTogether{"one core", 0, 0};

struct Samples {
  std::vector<double> medians, p99s;  // one per repetition, us
  bool checked = true;
  void add(std::vector<double> us) {
    if (us.empty()) {
      checked = false;
      return;
    }
    std::sort(us.begin(), us.end());
    medians.push_back(us[us.size() / 2]);
    p99s.push_back(us[us.size() * 99 / 100]);
  }
  static double middle(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v.empty() ? 0 : v[v.size() / 2];
  }
  double median() const { return middle(medians); }
  double p99() const { return middle(p99s); }
};

void pin(int cpu) {
  if (cpu < 0) return;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  if (::sched_setaffinity(0, sizeof set, &set) != 0) std::perror("exchange_bench: sched_setaffinity");
}

double us_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

void compute(double us) {
  for (const auto start = Clock::now(); us_since(start) < us;) {
  }
}

template <class F>
pid_t start_process(F work) {
  std::fflush(stdout);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::_exit(work() ? 0 : 1);
  }
  return pid;
}

bool ended_well(pid_t pid) {
  int status = 0;
  ::waitpid(pid, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Two processes, two words on lines of their own; fluid side measures in a child, too, so that pinning leaves no
/// trace.
struct Lines {
  alignas(128) std::atomic<std::uint32_t> ping;
  alignas(128) std::atomic<std::uint32_t> pong;
  alignas(128) double us[100'000];
};

void await_spinning(const std::atomic<std::uint32_t>& word, std::uint32_t value) {
  while (word.load(std::memory_order_acquire) != value) {
  }
}
void await_futex(const std::atomic<std::uint32_t>& word, std::uint32_t value) {
  for (std::uint32_t seen; (seen = word.load(std::memory_order_acquire)) != value;) {
    ::syscall(SYS_futex, &word, FUTEX_WAIT, seen, nullptr, nullptr, 0);
  }
}
void post_plain(std::atomic<std::uint32_t>& word, std::uint32_t value) { word.store(value, std::memory_order_release); }
void post_futex(std::atomic<std::uint32_t>& word, std::uint32_t value) {
  word.store(value, std::memory_order_release);
  ::syscall(SYS_futex, &word, FUTEX_WAKE, 1, nullptr, nullptr, 0);
}

template <auto Await, auto Post>
std::vector<double> bare(const Placement& at, std::uint32_t rounds, double gap_us) {
  void* memory = ::mmap(nullptr, sizeof(Lines), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return {};
  auto* lines = static_cast<Lines*>(memory);
  rounds = static_cast<std::uint32_t>(std::min<std::size_t>(rounds, std::size(lines->us)));
  const pid_t answering = start_process([&] {
    pin(at.second);
    for (std::uint32_t i = 1; i <= rounds; ++i) Await(lines->ping, i), Post(lines->pong, i);
    return true;
  });
  const pid_t asking = start_process([&] {
    pin(at.first);
    for (std::uint32_t i = 1; i <= rounds; ++i) {
      if (gap_us > 0) compute(gap_us);
      const auto start = Clock::now();
      Post(lines->ping, i);
      Await(lines->pong, i);
      lines->us[i - 1] = us_since(start);
    }
    return true;
  });
  const bool good = ended_well(answering) & ended_well(asking);
  std::vector<double> us(lines->us, lines->us + (good ? rounds : 0));
  ::munmap(memory, sizeof(Lines));
  return us;
}

/// Every number of every message differs from step to step and from body to body.
double content(std::uint64_t step, std::size_t i) { return static_cast<double>(step) + 1e-3 * static_cast<double>(i); }

template <class Record>
void write_content(std::vector<Record>& records, std::uint64_t step) {
  auto* values = reinterpret_cast<double*>(records.data());
  const std::size_t n = records.size() * sizeof(Record) / sizeof(double);
  for (std::size_t i = 0; i < n; ++i) values[i] = content(step, i);
}
template <class Record>
bool has_content(const std::vector<Record>& records, std::uint64_t step) {
  const auto* values = reinterpret_cast<const double*>(records.data());
  const std::size_t n = records.size() * sizeof(Record) / sizeof(double);
  bool good = true;
  for (std::size_t i = 0; i < n; ++i) good &= values[i] == content(step, i);
  return good;
}

/// States must carry unit quaternions, which the content is not: they are set aside, and checked by their own.
void write_states(std::vector<BodyState>& states, std::uint64_t step) {
  write_content(states, step);
  for (BodyState& s : states) std::fill_n(s.orientation, 4, 0.5);
}
bool check_states(std::vector<BodyState>& states, std::uint64_t step) {
  for (std::size_t b = 0; b < states.size(); ++b) {
    for (std::size_t k = 0; k < 4; ++k) {
      if (states[b].orientation[k] != 0.5) return false;
      states[b].orientation[k] = content(step, b * sizeof(BodyState) / 8 + 3 + k);
    }
  }
  return has_content(states, step);
}

bool rigid_process(const std::string& name, int cpu) {
  pin(cpu);
  auto segment = Segment::attach(name, Role::kRigid);
  if (!segment) return std::fprintf(stderr, "%s\n", segment.error().text().c_str()), false;
  RigidLink link(*segment);
  std::vector<BodyState> states(kBodies);
  std::vector<Wrench> wrenches(kBodies);
  std::vector<Contact> contacts;
  write_states(states, 0);
  for (Answer answer{};;) {
    if (auto s = link.send(answer, states); !s) return std::fprintf(stderr, "%s\n", s.error().text().c_str()), false;
    auto order = link.receive(wrenches, contacts);
    if (!order) return std::fprintf(stderr, "%s\n", order.error().text().c_str()), false;
    if (order->flags & kEnd) return link.finish(ballast::kFine, "") ? true : false;
    if (!has_content(wrenches, order->step)) return false;
    answer.step = order->step;
    write_states(states, order->step);
  }
}

bool fluid_process(const std::string& name, int cpu, Lines* out, std::uint32_t rounds, double gap_us) {
  pin(cpu);
  auto segment = Segment::attach(name, Role::kFluid);
  if (!segment) return std::fprintf(stderr, "%s\n", segment.error().text().c_str()), false;
  FluidLink link(*segment);
  std::vector<BodyState> states(kBodies);
  std::vector<Wrench> wrenches(kBodies);
  if (!link.receive(0, 0, states)) return false;
  Order order{};
  order.dt = 1e-3;
  for (order.step = 1; order.step <= rounds; ++order.step) {
    write_content(wrenches, order.step);
    if (gap_us > 0) compute(gap_us);
    const auto start = Clock::now();
    if (!link.send(order, wrenches, {})) return false;
    auto answer = link.receive(order.step, 0, states);
    out->us[order.step - 1] = us_since(start);
    if (!answer) return std::fprintf(stderr, "%s\n", answer.error().text().c_str()), false;
    if (!check_states(states, order.step)) return false;
  }
  return link.finish(ballast::kFine, "") ? true : false;
}

std::vector<double> ballast_exchange(const Placement& at, std::uint32_t rounds, double gap_us) {
  SegmentPlan plan;
  plan.manifest.world.dimension = 3;
  plan.manifest.bodies.assign(kBodies, BodyRecord{});
  auto segment = Segment::create(Segment::make_name(), plan);
  if (!segment) return std::fprintf(stderr, "%s\n", segment.error().text().c_str()), std::vector<double>{};
  void* memory = ::mmap(nullptr, sizeof(Lines), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) return {};
  auto* lines = static_cast<Lines*>(memory);
  const pid_t rigid = start_process([&] { return rigid_process(segment->name(), at.second); });
  const pid_t fluid = start_process([&] { return fluid_process(segment->name(), at.first, lines, rounds, gap_us); });
  const bool good = ended_well(fluid) & ended_well(rigid);
  std::vector<double> us(lines->us, lines->us + (good ? rounds : 0));
  ::munmap(memory, sizeof(Lines));
  return us;
}

struct Measurement {
  std::string name;
  std::string yardstick;  // name of the measurement that this one is divided by
  std::function<std::vector<double>()> run;
  Samples samples{};
};

constexpr auto kLine = bare<await_spinning, post_plain>;
constexpr auto kFutex = bare<await_futex, post_futex>;

std::vector<Measurement> measurements() {
  const std::string line = "cache line ping-pong, two cores";
  std::vector<Measurement> all{{line, "", [] { return kLine(kApart, 100'000, 0); }}};
  for (const Placement& at : {kApart, kFree, kTogether}) {
    const std::string where = std::string(", ") + at.name, futex = "bare futex" + where;
    const std::uint32_t rounds = at.first != at.second ? 5'000 : 20'000;
    all.push_back({futex, line, [at, rounds] { return kFutex(at, rounds, 0); }});
    all.push_back({"exchange of 32 bodies" + where, futex, [at, rounds] { return ballast_exchange(at, rounds, 0); }});
  }
  // The real pattern: the rigid process has slept for 5 ms when the order comes.
  for (const Placement& at : {kApart, kFree}) {
    const std::string where = std::string(", after 5 ms, ") + at.name, futex = "bare futex" + where;
    all.push_back({futex, line, [at] { return kFutex(at, 150, 5000); }});
    all.push_back({"exchange of 32 bodies" + where, futex, [at] { return ballast_exchange(at, 150, 5000); }});
  }
  return all;
}

nlohmann::json row(const Measurement& m, const char* what, double value, double yardstick) {
  return {{"name", "exchange: " + m.name + ", " + what},
          {"particles", 0},
          {"threads", 2},
          {"simd", "none"},
          {"value", value},
          {"unit", "us"},
          {"yardstick", m.yardstick.empty() ? m.name : m.yardstick},
          {"ratio", yardstick > 0 ? value / yardstick : 1.0},
          {"checked", m.samples.checked}};
}

}  // namespace

/// exchange_bench [--repetitions N] [--json [FILE]]; --json without a file prints the list instead of the table.
int main(int argc, char** argv) {
  int repetitions = 5;
  bool json = false;
  std::string file;
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc && argv[i + 1][0] != '-';
    if (std::strcmp(argv[i], "--json") == 0) {
      json = true;
      if (has_value) file = argv[++i];
    } else if (std::strcmp(argv[i], "--repetitions") == 0 && has_value) {
      repetitions = std::max(1, std::atoi(argv[++i]));
    } else {
      std::fprintf(stderr, "usage: exchange_bench [--repetitions N] [--json [FILE]]\n");
      return ballast::kBadInput;
    }
  }
  std::vector<Measurement> all = measurements();
  for (int r = 0; r < repetitions; ++r) {
    for (Measurement& m : all) m.samples.add(m.run());
  }
  std::map<std::string, double> medians;
  for (const Measurement& m : all) medians[m.name] = m.samples.median();
  nlohmann::json list = nlohmann::json::array();
  bool good = true;
  std::FILE* table = json && file.empty() ? stderr : stdout;
  std::fprintf(table, "%-48s %10s %10s %8s  %-36s %s\n", "round trip", "median us", "p99 us", "ratio", "to", "checked");
  for (const Measurement& m : all) {
    const double yardstick = m.yardstick.empty() ? 0 : medians[m.yardstick];
    list.push_back(row(m, "median", m.samples.median(), yardstick));
    list.push_back(row(m, "p99", m.samples.p99(), yardstick));
    good = good && m.samples.checked;
    std::fprintf(table, "%-48s %10.2f %10.2f %8.2f  %-36s %s\n", m.name.c_str(), m.samples.median(), m.samples.p99(),
                 yardstick > 0 ? m.samples.median() / yardstick : 1.0, m.yardstick.c_str(),
                 m.samples.checked ? "yes" : "NO");
  }
  if (json && file.empty()) std::printf("%s\n", list.dump(2).c_str());
  if (!file.empty()) {
    std::ofstream out(file);
    out << list.dump(2) << "\n";
    if (!out) {
      std::fprintf(stderr, "exchange_bench: cannot write %s\n", file.c_str());
      return ballast::kBadInput;
    }
  }
  return good ? ballast::kFine : ballast::kProcessFailed;
}
