// Both sides as threads over one mapping: lets ThreadSanitizer judge the memory orders, and counts allocations.
#include <atomic>

#include "tests/common/exchange/support.h"

extern std::atomic<std::uint64_t> allocations;  // count_allocations.cpp

namespace ballast::exchange::testing {
namespace {

TEST(threads, exchange_without_races_and_without_allocating) {
  constexpr std::uint64_t kSteps = 5000, kWarm = 20;
  auto segment = Segment::create(Segment::make_name(), plan_of(4));
  ASSERT_TRUE(segment);
  auto fluid_side = Segment::attach(segment->name(), Role::kFluid);
  auto rigid_side = Segment::attach(segment->name(), Role::kRigid);
  ASSERT_TRUE(fluid_side && rigid_side);
  Control control(*fluid_side);
  control.grant(kSteps);
  std::uint64_t wrong = 0, before = 0, after = 0;
  std::thread rigid([&] {
    RigidLink link(*fluid_side);  // the same mapping as the fluid's, on purpose
    std::vector<Wrench> wrenches(4);
    std::vector<BodyState> states(4);
    std::vector<Contact> contacts;
    fill(states, 0);
    if (!link.send({}, states)) ++wrong;
    for (std::uint64_t step = 1; step <= kSteps && wrong == 0; ++step) {
      if (!link.receive(wrenches, contacts)) ++wrong;
      fill(states, step);
      if (!link.send(answer_of(step), states)) ++wrong;
    }
  });
  FluidLink link(*fluid_side);
  std::vector<Wrench> wrenches(4);
  std::vector<BodyState> states(4), wanted(4);
  std::vector<Contact> contacts(6);
  fill(contacts, 1, 4);
  EXPECT_TRUE(link.receive(0, 0, states));
  for (std::uint64_t step = 1; step <= kSteps; ++step) {
    if (step == kWarm) before = allocations.load();
    EXPECT_TRUE(link.await_credit(step));
    fill(wrenches, step);
    if (!link.send(order_of(step), wrenches, contacts) || !link.receive(step, 0, states)) break;
    fill(wanted, step);
    if (!same<BodyState>(states, wanted)) break;
    if (step == kSteps) after = allocations.load();
  }
  rigid.join();
  EXPECT_EQ(wrong, 0u);
  ASSERT_GT(after, 0u) << "not all steps were exchanged";
  EXPECT_EQ(after, before) << "allocations in the steady state";
}

/// Posts, finishes and reports of both processes meet at the coordinator in a third thread.
TEST(threads, reports_of_two_writers_reach_one_coordinator) {
  auto segment = Segment::create(Segment::make_name(), plan_of(1));
  ASSERT_TRUE(segment);
  auto guest = Segment::attach(segment->name(), Role::kFluid);
  auto other = Segment::attach(segment->name(), Role::kRigid);
  ASSERT_TRUE(guest && other);
  constexpr std::uint64_t kReports = 3000;
  const auto write = [&](Role role) {
    Link link(*segment, role);
    for (std::uint64_t step = 1; step <= kReports; ++step) {
      if (!link.report(report_of(step))) return;
    }
    EXPECT_TRUE(link.finish(kFine, "{}"));
  };
  std::thread fluid(write, Role::kFluid), rigid(write, Role::kRigid);
  Control control(*segment);
  std::uint64_t next[2] = {1, 1};
  std::vector<Frame> frames;
  const auto start = std::chrono::steady_clock::now();
  while ((next[0] <= kReports || next[1] <= kReports) && seconds_since(start) < 60) {
    control.wait_for_news(std::chrono::milliseconds(500));
    for (Role role : {Role::kFluid, Role::kRigid}) {
      frames.clear();
      EXPECT_TRUE(control.drain(role, frames));
      for (const Frame& f : frames) {
        EXPECT_EQ(f.step_report().step, next[static_cast<int>(role)]++);
        EXPECT_EQ(f.step_report().time, report_of(f.head.step).time);
      }
    }
  }
  fluid.join();
  rigid.join();
  EXPECT_EQ(next[0], kReports + 1);
  EXPECT_EQ(next[1], kReports + 1);
}

}  // namespace
}  // namespace ballast::exchange::testing
