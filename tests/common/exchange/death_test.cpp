// A process that dies, hangs, fails or never comes must be named by those who wait for it, soon and with exit code 5.
#include <gmock/gmock.h>

#include "common/exchange/segment_impl.h"
#include "tests/common/exchange/support.h"

namespace ballast::exchange::testing {
namespace {

using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

constexpr double kBound = 0.5;  // s; promised are 0.2 s, the rest is for machines with more processes than cores

/// A pipe through which a child tells the text of the error it met, and when.
class Verdict {
 public:
  Verdict() { EXPECT_EQ(::pipe(ends_), 0); }
  ~Verdict() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  void tell(const Error& e) const {
    const std::string text = std::to_string(e.exit_code) + " " + e.text();
    if (::write(ends_[1], text.data(), text.size()) < 0) ::_exit(99);
  }
  std::string hear() const {
    char text[2000];
    const ssize_t n = ::read(ends_[0], text, sizeof text);
    return {text, static_cast<std::size_t>(std::max<ssize_t>(n, 0))};
  }

 private:
  int ends_[2];
};

/// Steps for ever, `pause` long each, until an error comes, which goes to the verdict.
int run_until_error(const std::string& name, Role role, const Verdict& verdict, milliseconds pause,
                    std::uint64_t silent_from = ~0ULL) {
  auto segment = Segment::attach(name, role);
  if (!segment) return fail(segment.error());
  const std::size_t n = segment->manifest().bodies.size();
  std::vector<Wrench> wrenches(n);
  std::vector<BodyState> states(n);
  std::vector<Contact> contacts;
  fill(states, 0);
  const auto give_up = [&](const Error& e) {
    verdict.tell(e);
    return 55;
  };
  if (role == Role::kRigid) {
    RigidLink link(*segment);
    if (auto s = link.send({}, states); !s) return give_up(s.error());
    for (std::uint64_t step = 1;; ++step) {
      if (auto o = link.receive(wrenches, contacts); !o) return give_up(o.error());
      if (step == silent_from) return link.finish(kDiverged, "") ? 0 : 1;
      std::this_thread::sleep_for(pause);
      if (auto s = link.send(answer_of(step), states); !s) return give_up(s.error());
    }
  }
  FluidLink link(*segment);
  if (auto a = link.receive(0, 0, states); !a) return give_up(a.error());
  for (std::uint64_t step = 1;; ++step) {
    if (step == silent_from) return link.finish(kDiverged, "") ? 0 : 1;
    std::this_thread::sleep_for(pause);
    if (auto s = link.send(order_of(step), wrenches, {}); !s) return give_up(s.error());
    if (auto a = link.receive(step, 0, states); !a) return give_up(a.error());
  }
}

std::uint64_t step_of(Segment& segment, Role role) { return segment.impl().peer(role).step.load(); }

/// Both processes in lockstep, each step lasting long enough to be caught in the middle of it.
struct Pair {
  explicit Pair(milliseconds fluid_pause, milliseconds rigid_pause, double timeout = 30,
                std::uint64_t fluid_fails = ~0ULL, std::uint64_t rigid_fails = ~0ULL)
      : segment([&] {
          SegmentPlan plan = plan_of(2);
          plan.peer_timeout = timeout;
          return Segment::create(Segment::make_name(), plan);
        }()),
        fluid([&, name = segment->name()] {
          return run_until_error(name, Role::kFluid, fluid_verdict, fluid_pause, fluid_fails);
        }),
        rigid([&, name = segment->name()] {
          return run_until_error(name, Role::kRigid, rigid_verdict, rigid_pause, rigid_fails);
        }) {}
  bool reaches_step(std::uint64_t step) {
    return becomes_true(
        [&] { return step_of(*segment, Role::kFluid) >= step && step_of(*segment, Role::kRigid) >= step; });
  }
  Verdict fluid_verdict, rigid_verdict;
  Result<Segment> segment;
  Child fluid, rigid;
};

TEST(death, of_the_rigid_process_is_named_by_the_fluid) {
  Pair run(milliseconds(1), milliseconds(3000));  // killed in the middle of its work on step 1
  ASSERT_TRUE(run.reaches_step(1));
  const std::string victim = "the rigid process (pid " + std::to_string(run.rigid.pid()) + ") died during step 1";
  const auto start = Clock::now();
  run.rigid.send(SIGKILL);  // not yet waited for: a zombie counts as dead
  EXPECT_THAT(run.fluid_verdict.hear(), AllOf(HasSubstr("5 " + victim), HasSubstr("dmesg")));
  EXPECT_LT(seconds_since(start), kBound);
  EXPECT_EQ(Control(*run.segment).state(Role::kRigid), PeerState::kDead);
  EXPECT_EQ(run.fluid.wait(), 55);
}

TEST(death, of_the_fluid_process_is_named_by_the_rigid) {
  Pair run(milliseconds(200), milliseconds(1));
  ASSERT_TRUE(run.reaches_step(3));
  const auto start = Clock::now();
  run.fluid.send(SIGKILL);
  run.fluid.wait();  // and one that is gone altogether counts as dead, too
  EXPECT_THAT(run.rigid_verdict.hear(), HasSubstr(") died during step 3"));
  EXPECT_LT(seconds_since(start), kBound);
  EXPECT_EQ(run.rigid.wait(), 55);
}

/// Short steps: neither ever sleeps for a whole slice, and nobody ever waits for the coordinator.
TEST(death, of_the_coordinator_in_the_midst_of_short_steps_is_named_and_its_segment_removed) {
  Verdict fluid_verdict, rigid_verdict, name_pipe;
  Child coordinator([&] {
    auto segment = Segment::create(Segment::make_name(), plan_of(2));
    if (!segment) return fail(segment.error());
    name_pipe.tell({.what = segment->name(), .cure = "", .where = ""});
    std::this_thread::sleep_for(std::chrono::seconds(60));
    return 0;
  });
  const std::string name = name_pipe.hear().substr(2);
  ASSERT_TRUE(in_shm(name));
  Child fluid([&] { return run_until_error(name, Role::kFluid, fluid_verdict, milliseconds(1)); });
  Child rigid([&] { return run_until_error(name, Role::kRigid, rigid_verdict, milliseconds(1)); });
  std::this_thread::sleep_for(milliseconds(100));
  const int pid = coordinator.pid();
  const auto start = Clock::now();
  coordinator.send(SIGKILL);
  // Whoever sees it first ends; the other may then name either of the two.
  EXPECT_EQ(fluid.wait(), 55);
  EXPECT_EQ(rigid.wait(), 55);
  EXPECT_LT(seconds_since(start), 2 * kBound);
  EXPECT_THAT(fluid_verdict.hear() + rigid_verdict.hear(),
              HasSubstr("the coordinator (pid " + std::to_string(pid) + ") died during step"));
  EXPECT_FALSE(in_shm(name)) << "the last to go must remove the segment that the killed coordinator left";
}

TEST(death, of_the_coordinator_ends_a_wait_for_credit) {
  Verdict verdict, name_pipe;
  Child coordinator([&] {
    auto segment = Segment::create(Segment::make_name(), plan_of(2));
    if (!segment) return fail(segment.error());
    name_pipe.tell({.what = segment->name(), .cure = "", .where = ""});
    std::this_thread::sleep_for(std::chrono::seconds(60));
    return 0;
  });
  const std::string name = name_pipe.hear().substr(2);
  Child fluid([&] {
    auto segment = Segment::attach(name, Role::kFluid);
    if (!segment) return fail(segment.error());
    FluidLink link(*segment);
    auto go = link.await_credit(1);
    if (!go) verdict.tell(go.error());
    return 55;
  });
  std::this_thread::sleep_for(milliseconds(100));
  const auto start = Clock::now();
  coordinator.send(SIGKILL);
  EXPECT_THAT(verdict.hear(), HasSubstr("5 the coordinator (pid "));
  EXPECT_LT(seconds_since(start), kBound);
  EXPECT_EQ(fluid.wait(), 55);
  EXPECT_FALSE(in_shm(name));
}

TEST(failure, of_the_peer_is_told_with_its_exit_code) {
  Pair run(milliseconds(1), milliseconds(1), 30, ~0ULL, 4);
  EXPECT_THAT(run.fluid_verdict.hear(), HasSubstr(") ended with exit code 4 during step 4"));
  EXPECT_EQ(run.fluid.wait(), 55);
  Pair other(milliseconds(1), milliseconds(1), 30, 6);
  EXPECT_THAT(other.rigid_verdict.hear(), HasSubstr(") ended with exit code 4 during step 5"));
  EXPECT_EQ(other.rigid.wait(), 55);
}

TEST(failure, a_rigid_process_that_leaves_an_order_unanswered_is_named) {
  auto segment = Segment::create(Segment::make_name(), plan_of(1));
  ASSERT_TRUE(segment);
  Verdict verdict;
  Child fluid([&] { return run_until_error(segment->name(), Role::kFluid, verdict, milliseconds(1)); });
  Child rigid([&] {
    auto mine = Segment::attach(segment->name(), Role::kRigid);
    if (!mine) return fail(mine.error());
    RigidLink link(*mine);
    std::vector<BodyState> states(1);
    fill(states, 0);
    if (!link.send({}, states)) return 1;
    return link.finish(kFine, "") ? 0 : 2;
  });
  EXPECT_THAT(verdict.hear(), HasSubstr(") finished without an answer to step 1"));
  EXPECT_EQ(fluid.wait(), 55);
  EXPECT_EQ(rigid.wait(), 0);
}

TEST(silence, of_a_stopped_peer_is_an_error_after_the_timeout) {
  for (Role role : {Role::kRigid, Role::kFluid}) {
    Pair run(milliseconds(20), milliseconds(20), 0.3);
    ASSERT_TRUE(run.reaches_step(2));
    Child& victim = role == Role::kRigid ? run.rigid : run.fluid;
    const auto start = Clock::now();
    victim.send(SIGSTOP);
    const Verdict& verdict = role == Role::kRigid ? run.fluid_verdict : run.rigid_verdict;
    EXPECT_THAT(verdict.hear(), AllOf(HasSubstr(std::string("5 the ") + role_name(role)),
                                      HasSubstr("no sign of life for 0.3"), HasSubstr("during step ")));
    EXPECT_GT(seconds_since(start), 0.2) << "the wait may have begun a victim's pause before the stop";
    EXPECT_LT(seconds_since(start), 0.3 + kBound);
  }
}

/// Ctrl-Z stops all processes of a run alike; when they go on, nobody may hold the pause against the others.
TEST(silence, while_oneself_was_stopped_does_not_count) {
  Pair run(milliseconds(30), milliseconds(30), 0.4);
  ASSERT_TRUE(run.reaches_step(2));
  run.fluid.send(SIGSTOP);
  run.rigid.send(SIGSTOP);
  std::this_thread::sleep_for(milliseconds(1000));
  run.fluid.send(SIGCONT);  // the fluid alone first: it may now wait up to a slice or two for the rigid process
  std::this_thread::sleep_for(milliseconds(20));
  run.rigid.send(SIGCONT);
  const std::uint64_t step = step_of(*run.segment, Role::kFluid);
  EXPECT_TRUE(run.reaches_step(step + 5));
}

TEST(silence, beats_from_within_a_long_computation_are_signs_of_life) {
  SegmentPlan plan = plan_of(1);
  plan.peer_timeout = 0.2;
  auto segment = Segment::create(Segment::make_name(), plan);
  ASSERT_TRUE(segment);
  for (bool beats : {true, false}) {
    auto next = Segment::create(Segment::make_name(), plan);
    ASSERT_TRUE(next);
    Verdict verdict;
    Child rigid([&] {
      auto mine = Segment::attach(next->name(), Role::kRigid);
      if (!mine) return fail(mine.error());
      RigidLink link(*mine);
      for (int i = 0; i < 40; ++i) {
        std::this_thread::sleep_for(milliseconds(20));
        if (beats) link.beat();
      }
      std::vector<BodyState> states(1);
      fill(states, 0);
      return link.send({}, states) ? 0 : 1;
    });
    Child fluid([&] {
      auto mine = Segment::attach(next->name(), Role::kFluid);
      if (!mine) return fail(mine.error());
      FluidLink link(*mine);
      std::vector<BodyState> states(1);
      return link.receive(0, 0, states) ? 1 : 2;
    });
    EXPECT_EQ(fluid.wait(), beats ? 1 : 2);
  }
}

TEST(absence, of_a_peer_is_an_error_after_the_timeout_and_at_once_after_a_stop) {
  SegmentPlan plan = plan_of(1);
  plan.peer_timeout = 0.2;
  for (bool stopped : {false, true}) {
    if (stopped) plan.peer_timeout = 1000;
    auto segment = Segment::create(Segment::make_name(), plan);
    ASSERT_TRUE(segment);
    if (stopped) Control(*segment).stop();
    auto mine = Segment::attach(segment->name(), Role::kFluid);
    ASSERT_TRUE(mine);
    FluidLink link(*mine);
    std::vector<BodyState> states(1);
    const auto start = Clock::now();
    auto answer = link.receive(0, 0, states);
    ASSERT_FALSE(answer);
    EXPECT_LT(seconds_since(start), 0.2 + kBound);
    EXPECT_EQ(answer.error().exit_code, kProcessFailed);
    EXPECT_THAT(answer.error().text(), HasSubstr(stopped ? "the rigid process had not attached when the run was stopped"
                                                         : "the rigid process has not attached within 0.2 s"));
  }
}

TEST(death, wakes_a_coordinator_that_waits_for_news) {
  auto segment = Segment::create(Segment::make_name(), plan_of(1));
  ASSERT_TRUE(segment);
  Child fluid([&] {
    auto mine = Segment::attach(segment->name(), Role::kFluid);
    std::this_thread::sleep_for(milliseconds(60'000));
    return 0;
  });
  Control control(*segment);
  ASSERT_TRUE(becomes_true([&] { return control.state(Role::kFluid) == PeerState::kRunning; }));
  control.wait_for_news(milliseconds(1));
  fluid.send(SIGKILL);
  const auto start = Clock::now();
  control.wait_for_news(milliseconds(20'000));
  EXPECT_LT(seconds_since(start), kBound);
  EXPECT_EQ(control.state(Role::kFluid), PeerState::kDead);
}

}  // namespace
}  // namespace ballast::exchange::testing
