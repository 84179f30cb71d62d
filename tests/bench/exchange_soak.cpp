// Soak of the waiting: millions of checked round trips between two processes, in which no wake-up may be lost.
// The slice of a wait is 20 s here, so that a lost wake-up is a stall that nothing else can cause, and is counted.
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <vector>

#include "common/exchange/segment_impl.h"

namespace {

using namespace ballast::exchange;

constexpr std::chrono::seconds kSlice{20};

int failed(const ballast::Error& e) {
  std::fprintf(stderr, "exchange_soak: %s\n", e.text().c_str());
  return 1;
}

int failed(const char* role, std::uint64_t step) {
  std::fprintf(stderr, "exchange_soak: %s got a wrong message at step %llu\n", role,
               static_cast<unsigned long long>(step));
  return 1;
}

/// Ties this process to one processor; negative: leaves it free.
void pin(int cpu) {
  if (cpu < 0) return;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  if (::sched_setaffinity(0, sizeof set, &set) != 0) std::perror("exchange_soak: sched_setaffinity");
}

int rigid(const std::string& name, int cpu) {
  pin(cpu);
  auto segment = Segment::attach(name, Role::kRigid);
  if (!segment) return failed(segment.error());
  segment->impl().slice = kSlice;
  RigidLink link(*segment);
  std::vector<BodyState> states(1);
  std::vector<Wrench> wrenches(1);
  std::vector<Contact> contacts;
  states[0].orientation[0] = 1;
  if (auto s = link.send({}, states); !s) return failed(s.error());
  for (;;) {
    auto order = link.receive(wrenches, contacts);
    if (!order) return failed(order.error());
    if (wrenches[0].torque[2] != static_cast<double>(order->step)) return failed("rigid process", order->step);
    Answer answer{};
    answer.step = order->step;
    states[0].mobility[35] = -static_cast<double>(order->step);
    if (auto s = link.send(answer, states); !s) return failed(s.error());
    if (order->flags & kLast) break;
  }
  if (link.late_wakes() != 0)
    std::fprintf(stderr, "rigid process: %llu lost wake-ups\n", (unsigned long long)link.late_wakes());
  return link.late_wakes() == 0 ? 0 : 2;
}

int fluid(const std::string& name, int cpu, std::uint64_t steps) {
  pin(cpu);
  auto segment = Segment::attach(name, Role::kFluid);
  if (!segment) return failed(segment.error());
  segment->impl().slice = kSlice;
  FluidLink link(*segment);
  std::vector<BodyState> states(1);
  std::vector<Wrench> wrenches(1);
  if (auto a = link.receive(0, 0, states); !a) return failed(a.error());
  const auto start = std::chrono::steady_clock::now();
  for (std::uint64_t step = 1; step <= steps; ++step) {
    Order order{};
    order.step = step;
    order.dt = 1;
    order.flags = step == steps ? kLast : 0u;
    wrenches[0].torque[2] = static_cast<double>(step);
    if (auto s = link.send(order, wrenches, {}); !s) return failed(s.error());
    if (auto a = link.receive(step, 0, states); !a) return failed(a.error());
    if (states[0].mobility[35] != -static_cast<double>(step)) return failed("fluid process", step);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto count = [](std::uint64_t n) { return static_cast<unsigned long long>(n); };
  std::printf("%llu round trips in %.1f s, %.2f us each; the fluid process slept %llu times, lost wake-ups: %llu\n",
              count(steps), seconds, 1e6 * seconds / static_cast<double>(steps), count(link.waits()),
              count(link.late_wakes()));
  return link.late_wakes() == 0 ? 0 : 2;
}

template <class F>
pid_t start(F work) {
  std::fflush(stdout);
  const pid_t pid = ::fork();
  if (pid == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const int code = work();
    std::fflush(stdout);
    ::_exit(code);
  }
  return pid;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Millions of checked round trips between two processes; no wake-up may be lost"};
  std::uint64_t steps = 10'000'000;
  std::string cores = "2";
  app.add_option("--round-trips", steps, "How many")->capture_default_str();
  app.add_option("--cores", cores, "2: one each; 1: both on one; free: as the kernel likes")
      ->check(CLI::IsMember({"1", "2", "free"}))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  SegmentPlan plan;
  plan.manifest.world.dimension = 3;
  plan.manifest.bodies.assign(1, BodyRecord{});
  auto segment = Segment::create(Segment::make_name(), plan);
  if (!segment) return failed(segment.error());
  const std::string name = segment->name();
  const int first = cores == "free" ? -1 : 0, second = cores == "free" ? -1 : cores == "2" ? 1 : 0;
  const pid_t children[] = {start([&] { return rigid(name, first); }),
                            start([&] { return fluid(name, second, steps); })};
  bool good = true;
  for (pid_t child : children) {
    int status = 0;
    ::waitpid(child, &status, 0);
    good = good && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  std::printf("%s\n", good ? "passed" : "FAILED");
  return good ? 0 : 1;
}
