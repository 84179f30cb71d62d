// Two real processes exchange messages whose every byte is checked; credit, stop and runs of one process.
#include "common/exchange/layout.h"
#include "common/exchange/segment_impl.h"
#include "tests/common/exchange/support.h"

namespace ballast::exchange::testing {
namespace {

using std::chrono::milliseconds;

TEST(lockstep, hundred_thousand_steps_arrive_complete_and_in_order) {
  auto segment = Segment::create(Segment::make_name(), plan_of(5));
  ASSERT_TRUE(segment) << segment.error().text();
  const std::string name = segment->name();
  Child rigid([&] { return run_rigid(name); });
  Child fluid([&] { return run_fluid(name, 100'000); });
  EXPECT_EQ(fluid.wait(), 0);
  EXPECT_EQ(rigid.wait(), 0);
  Control control(*segment);
  EXPECT_EQ(control.state(Role::kFluid), PeerState::kFinished);
  EXPECT_EQ(control.final_report(Role::kRigid), "{\"rigid\":1}");
  EXPECT_EQ(control.exit_code(Role::kRigid), kFine);
}

TEST(lockstep, works_with_no_bodies_at_all) {
  auto segment = Segment::create(Segment::make_name(), plan_of(0));
  ASSERT_TRUE(segment) << segment.error().text();
  const std::string name = segment->name();
  const auto empty = [&](Role role) {
    auto mine = Segment::attach(name, role);
    if (!mine) return fail(mine.error());
    std::vector<Contact> contacts;
    if (role == Role::kRigid) {
      RigidLink link(*mine);
      return link.send({}, {}) && link.receive({}, contacts) && link.send(answer_of(1), {}) ? 0 : 1;
    }
    FluidLink link(*mine);
    return link.receive(0, 0, {}) && link.send(order_of(1), {}, {}) && link.receive(1, 0, {}) ? 0 : 1;
  };
  Child rigid([&] { return empty(Role::kRigid); });
  Child fluid([&] { return empty(Role::kFluid); });
  EXPECT_EQ(fluid.wait(), 0);
  EXPECT_EQ(rigid.wait(), 0);
}

/// The rigid process restores on every order with kRollBack; iterations count from 0 within each step.
TEST(lockstep, repeats_a_step_as_often_as_the_fluid_wants) {
  auto segment = Segment::create(Segment::make_name(), plan_of(1));
  ASSERT_TRUE(segment) << segment.error().text();
  const std::string name = segment->name();
  Child rigid([&] {
    auto mine = Segment::attach(name, Role::kRigid);
    if (!mine) return fail(mine.error());
    RigidLink link(*mine);
    std::vector<Wrench> wrenches(1);
    std::vector<BodyState> states(1);
    std::vector<Contact> contacts;
    fill(states, 0);
    if (!link.send({}, states)) return 1;
    for (std::uint64_t orders = 1;; ++orders) {
      auto o = link.receive(wrenches, contacts);
      if (!o) return fail(o.error());
      if (o->step * 10 + o->iteration != 10 * ((orders + 2) / 3) + (orders - 1) % 3) return fail("order");
      if (((o->flags & kRollBack) != 0) != (o->iteration != 0)) return fail("flags");
      if (!link.send(answer_of(o->step, o->iteration), states)) return 2;
      if (o->flags & kLast) return 0;
    }
  });
  Child fluid([&] {
    auto mine = Segment::attach(name, Role::kFluid);
    if (!mine) return fail(mine.error());
    FluidLink link(*mine);
    std::vector<Wrench> wrenches(1);
    std::vector<BodyState> states(1);
    if (!link.receive(0, 0, states)) return 1;
    for (std::uint64_t step = 1; step <= 100; ++step) {
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t flags = (i ? kRollBack : 0u) | (step == 100 && i == 2 ? kLast : 0u);
        if (!link.send(order_of(step, flags, i), wrenches, {})) return 2;
        if (auto a = link.receive(step, i, states); !a) return fail(a.error());
      }
    }
    return 0;
  });
  EXPECT_EQ(fluid.wait(), 0);
  EXPECT_EQ(rigid.wait(), 0);
}

TEST(credit, lets_no_step_begin_before_it_is_granted) {
  auto segment = Segment::create(Segment::make_name(), plan_of(2));
  ASSERT_TRUE(segment) << segment.error().text();
  const std::string name = segment->name();
  Control control(*segment);
  Child rigid([&] { return run_rigid(name); });
  Child fluid([&] { return run_fluid(name, 9, true); });
  std::vector<Frame> frames;
  for (std::uint64_t granted : {3u, 4u, 9u}) {
    control.grant(granted);
    ASSERT_TRUE(becomes_true([&] {
      control.wait_for_news(milliseconds(20));
      EXPECT_TRUE(control.drain(Role::kFluid, frames));
      return frames.size() >= granted;
    }));
    std::this_thread::sleep_for(milliseconds(60));  // more than a slice: whoever wanted to overtake has had its chance
    EXPECT_TRUE(control.drain(Role::kFluid, frames));
    EXPECT_EQ(frames.size(), granted);
    EXPECT_EQ(frames.back().step_report().step, granted);
  }
  EXPECT_EQ(fluid.wait(), 0);
  EXPECT_EQ(rigid.wait(), 0);
}

/// Whatever the moment of the stop, both end after the same step.
TEST(stop, ends_both_processes_after_the_same_step) {
  for (int round = 0; round < 20; ++round) {
    auto segment = Segment::create(Segment::make_name(), plan_of(2));
    ASSERT_TRUE(segment) << segment.error().text();
    const std::string name = segment->name();
    Control control(*segment);
    control.grant(1'000'000);
    Child rigid([&] { return run_rigid(name); });
    Child fluid([&] { return run_fluid(name, 1'000'000, true); });
    std::vector<Frame> frames;
    std::uint64_t reported = 0;
    const auto take = [&] {
      frames.clear();
      EXPECT_TRUE(control.drain(Role::kFluid, frames));
      if (!frames.empty()) reported = frames.back().head.step;
    };
    ASSERT_TRUE(becomes_true([&] { return take(), reported > static_cast<std::uint64_t>(round * 37); }));
    control.stop();
    ASSERT_TRUE(becomes_true([&] { return take(), control.state(Role::kFluid) == PeerState::kFinished; }));
    EXPECT_EQ(fluid.wait(), 0);
    EXPECT_EQ(rigid.wait(), 0);
    take();
    Header& header = segment->impl().header();
    EXPECT_EQ(header.peers[0].step.load(), reported);
    EXPECT_EQ(header.peers[1].step.load(), reported);
    EXPECT_EQ(header.gate.load(), kClosed | reported);
  }
}

/// Both ask for credit, as a rigid process may where no step is repeated.
TEST(stop, never_lets_one_process_begin_a_step_that_the_other_refuses) {
  for (int round = 0; round < 50; ++round) {
    auto segment = Segment::create(Segment::make_name(), plan_of(0));
    ASSERT_TRUE(segment) << segment.error().text();
    const std::string name = segment->name();
    Control control(*segment);
    control.grant(~0ULL >> 2);
    const auto run = [&](Role role) {
      auto mine = Segment::attach(name, role);
      if (!mine) return fail(mine.error());
      Link link(*mine, role);
      for (std::uint64_t step = 1;; ++step) {
        auto go = link.await_credit(step);
        if (!go) return fail(go.error());
        if (!*go) return link.finish(kFine, std::to_string(step - 1)) ? 0 : 2;
      }
    };
    Child rigid([&] { return run(Role::kRigid); });
    Child fluid([&] { return run(Role::kFluid); });
    ASSERT_TRUE(becomes_true([&] { return (segment->impl().header().gate.load() & ~kClosed) > 100; }));
    control.stop();
    EXPECT_EQ(fluid.wait(), 0);
    EXPECT_EQ(rigid.wait(), 0);
    // They run freely, so one may be ahead: the other follows up to the same step.
    EXPECT_EQ(control.final_report(Role::kFluid), control.final_report(Role::kRigid));
  }
}

class OneProcess : public ::testing::TestWithParam<Role> {};

TEST_P(OneProcess, runs_alone_on_credit_and_reports) {
  SegmentPlan plan = plan_of(3);
  plan.fluid = GetParam() == Role::kFluid;
  plan.rigid = !plan.fluid;
  auto segment = Segment::create(Segment::make_name(), plan);
  ASSERT_TRUE(segment) << segment.error().text();
  EXPECT_LT(segment->bytes(), 100'000u) << "what is left out must cost nothing";
  const std::string name = segment->name();
  const Role other = plan.fluid ? Role::kRigid : Role::kFluid;
  EXPECT_FALSE(Segment::attach(name, other));
  Control control(*segment);
  Child child([&] {
    auto mine = Segment::attach(name, GetParam());
    if (!mine) return fail(mine.error());
    Link link(*mine, GetParam());
    for (std::uint64_t step = 1;; ++step) {
      auto go = link.await_credit(step);
      if (!go) return fail(go.error());
      if (!*go) break;
      const double values[2] = {static_cast<double>(step), -1};
      if (!link.frame(FrameKind::kProbes, step, 0.5, values)) return 2;
      if (!link.warning(step, 0.5, "cup is full")) return 3;
    }
    return link.finish(kFine, "{}") ? 0 : 4;
  });
  control.grant(2);
  std::vector<Frame> frames;
  ASSERT_TRUE(becomes_true([&] {
    control.wait_for_news(milliseconds(100));
    return control.drain(GetParam(), frames) && frames.size() == 4;
  }));
  EXPECT_EQ(frames[2].head.step, 2u);
  ASSERT_EQ(frames[2].values().size(), 2u);
  EXPECT_EQ(frames[2].values()[0], 2.0);
  EXPECT_EQ(frames[3].text(), "cup is full");
  control.stop();
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(control.state(other), PeerState::kAbsent);
}

INSTANTIATE_TEST_SUITE_P(each, OneProcess, ::testing::Values(Role::kFluid, Role::kRigid),
                         [](const auto& i) { return i.param == Role::kFluid ? "fluid" : "rigid"; });

TEST(lockstep, calls_out_of_turn_are_refused) {
  auto segment = Segment::create(Segment::make_name(), plan_of(1));
  ASSERT_TRUE(segment) << segment.error().text();
  auto fluid = Segment::attach(segment->name(), Role::kFluid);
  auto rigid = Segment::attach(segment->name(), Role::kRigid);
  ASSERT_TRUE(fluid && rigid);
  FluidLink f(*fluid);
  RigidLink r(*rigid);
  std::vector<Wrench> wrenches(1);
  std::vector<BodyState> states(1);
  std::vector<Contact> contacts;
  fill(states, 0);
  EXPECT_FALSE(f.send(order_of(1), wrenches, {}));
  EXPECT_FALSE(r.receive(wrenches, contacts));
  ASSERT_TRUE(r.send({}, states));
  EXPECT_FALSE(r.send({}, states));
  ASSERT_TRUE(f.receive(0, 0, states));
  EXPECT_FALSE(f.receive(0, 0, states));
  EXPECT_FALSE(f.send(order_of(1), {}, {})) << "one wrench per body";
  contacts.assign(1, Contact{});
  contacts[0].body = 1;
  EXPECT_FALSE(f.send(order_of(1), wrenches, contacts)) << "no such body";
}

}  // namespace
}  // namespace ballast::exchange::testing
