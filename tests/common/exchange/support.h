// Children by fork, a plan with bodies, and message contents that both sides can compute: what the tests here share.
#pragma once
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <thread>

#include "common/exchange/link.h"

namespace ballast::exchange::testing {

/// A forked process that runs `work` and ends with its value; it dies with the test.
class Child {
 public:
  explicit Child(const std::function<int()>& work) {
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::_exit(work());
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      wait();
    }
  }
  void send(int signal) const { ::kill(pid_, signal); }
  int pid() const { return pid_; }
  /// Exit status; -signal if a signal ended it.
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  int pid_ = -1;
};

inline SegmentPlan plan_of(std::size_t bodies) {
  SegmentPlan plan;
  plan.manifest.world.dimension = 3;
  plan.manifest.world.gravity[2] = -9.81;
  for (std::size_t i = 0; i < bodies; ++i) {
    BodyRecord body{};
    std::snprintf(body.name, sizeof body.name, "crate%zu", i);
    body.orientation[0] = 1;
    plan.manifest.bodies.push_back(body);
  }
  plan.scene_text = "ballast: 1\n";
  plan.out_dir = "/tmp/out";
  plan.report_bytes = 1 << 16;
  plan.final_bytes = 1 << 12;
  plan.contact_bytes = 1 << 14;
  return plan;
}

/// A value that depends on every argument, so that a stale or foreign message cannot pass for the right one.
/// Not `step * constant`: GCC 12.2 -O3 then loses the end of the caller's loop over steps (-fno-ivopts keeps it).
inline double content(std::uint64_t step, std::size_t body, int field) {
  std::uint64_t x = step ^ (std::uint64_t{body} << 32) ^ (static_cast<std::uint64_t>(field) << 48);
  x = (x ^ (x >> 31)) * 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 29)) * 0x94d049bb133111ebULL;
  return static_cast<double>(x >> 12) * 0x1p-52 - 0.5;
}

inline void fill(std::span<Wrench> wrenches, std::uint64_t step) {
  for (std::size_t b = 0; b < wrenches.size(); ++b) {
    for (int k = 0; k < 3; ++k) {
      wrenches[b].force[k] = content(step, b, k);
      wrenches[b].torque[k] = content(step, b, 3 + k);
    }
  }
}

inline void fill(std::span<BodyState> states, std::uint64_t step) {
  for (std::size_t b = 0; b < states.size(); ++b) {
    double values[61];
    for (int k = 0; k < 61; ++k) values[k] = content(step, b, 100 + k);
    std::memcpy(&states[b], values, sizeof values);
    const double angle = values[3];
    const double unit[4] = {std::cos(angle), 0, std::sin(angle), 0};
    std::memcpy(states[b].orientation, unit, sizeof unit);
  }
}

inline void fill(std::span<Contact> contacts, std::uint64_t step, std::size_t bodies) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Contact& c = contacts[i];
    c = {};
    c.body = static_cast<std::uint32_t>(i % bodies);
    c.samples = static_cast<std::uint32_t>(step % 1000 + i);
    for (int k = 0; k < 3; ++k) {
      c.position[k] = content(step, i, 200 + k);
      c.force[k] = content(step, i, 210 + k);
    }
    c.normal[i % 3] = 1;
    c.depth = content(step, i, 220);
    c.area = 0.5 + std::abs(content(step, i, 221));
  }
}

template <class T>
bool same(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

inline Order order_of(std::uint64_t step, std::uint32_t flags = 0, std::uint32_t iteration = 0) {
  Order o{};
  o.step = step;
  o.iteration = iteration;
  o.flags = flags;
  o.dt = 1e-3;
  return o;
}

inline Answer answer_of(std::uint64_t step, std::uint32_t iteration = 0) {
  Answer a{};
  a.step = step;
  a.iteration = iteration;
  a.hash = 3 * step;
  return a;
}

inline StepReport report_of(std::uint64_t step) {
  StepReport r{};
  r.step = step;
  r.time = 0.1 * static_cast<double>(step);
  return r;
}

/// In a child: prints what went wrong and gives the exit code that the test then sees.
inline int fail(const Error& error) {
  std::fprintf(stderr, "child %d: %s\n", ::getpid(), error.text().c_str());
  return 10 + error.exit_code;
}
inline int fail(const char* what) {
  std::fprintf(stderr, "child %d: %s\n", ::getpid(), what);
  return 1;
}

/// Number of contacts in a step: varies, so that the ring wraps at every possible place.
inline std::size_t contact_count(std::uint64_t step) { return step % 7; }

/// A rigid process that checks each order and answers it, until kLast or kEnd; 0 if all was right.
inline int run_rigid(const std::string& name, std::uint64_t last_step_expected = 0) {
  auto segment = Segment::attach(name, Role::kRigid);
  if (!segment) return fail(segment.error());
  RigidLink link(*segment);
  const std::size_t n = segment->manifest().bodies.size();
  std::vector<Wrench> wrenches(n), wanted(n);
  std::vector<BodyState> states(n);
  std::vector<Contact> contacts, wanted_contacts;
  fill(states, 0);
  if (auto s = link.send(Answer{}, states); !s) return fail(s.error());
  for (std::uint64_t step = 1;; ++step) {
    auto order = link.receive(wrenches, contacts);
    if (!order) return fail(order.error());
    if (order->flags & kEnd) {
      if (last_step_expected != 0 && order->step != last_step_expected) return fail("ended after the wrong step");
      break;
    }
    fill(wanted, step);
    wanted_contacts.resize(contact_count(step));
    fill(wanted_contacts, step, n);
    if (order->step != step) return fail("wrong step");
    if (!same<Wrench>(wrenches, wanted)) return fail("wrong wrenches");
    if (!same<Contact>(contacts, wanted_contacts)) return fail("wrong contacts");
    fill(states, step);
    if (auto s = link.send(answer_of(step), states); !s) return fail(s.error());
    if (order->flags & kLast) break;
  }
  if (auto s = link.finish(kFine, "{\"rigid\":1}"); !s) return fail(s.error());
  return 0;
}

/// A fluid process that drives `steps` steps, waiting for credit before each; 0 if all answers were right.
inline int run_fluid(const std::string& name, std::uint64_t steps, bool credit = false) {
  auto segment = Segment::attach(name, Role::kFluid);
  if (!segment) return fail(segment.error());
  FluidLink link(*segment);
  const std::size_t n = segment->manifest().bodies.size();
  std::vector<Wrench> wrenches(n);
  std::vector<BodyState> states(n), wanted(n);
  std::vector<Contact> contacts;
  if (auto a = link.receive(0, 0, states); !a) return fail(a.error());
  for (std::uint64_t step = 1; step <= steps; ++step) {
    if (credit) {
      auto go = link.await_credit(step);
      if (!go) return fail(go.error());
      if (!*go) break;
      if (auto s = link.report(report_of(step)); !s) return fail(s.error());
    }
    fill(wrenches, step);
    contacts.resize(contact_count(step));
    fill(contacts, step, n);
    const std::uint32_t flags = step == steps ? kLast : 0u;
    if (auto s = link.send(order_of(step, flags), wrenches, contacts); !s) return fail(s.error());
    auto answer = link.receive(step, 0, states);
    if (!answer) return fail(answer.error());
    fill(wanted, step);
    if (answer->hash != step * 3) return fail("wrong hash");
    if (!same<BodyState>(states, wanted)) return fail("wrong states");
  }
  if (auto s = link.finish(kFine, "{\"fluid\":1}"); !s) return fail(s.error());
  return 0;
}

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Waits, at most 5 s, until something becomes true.
inline bool becomes_true(const std::function<bool()>& condition) {
  const auto start = std::chrono::steady_clock::now();
  while (!condition()) {
    if (seconds_since(start) > 5) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

inline bool in_shm(const std::string& name) { return ::access(("/dev/shm/" + name).c_str(), F_OK) == 0; }

}  // namespace ballast::exchange::testing
