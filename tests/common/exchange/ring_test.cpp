// Rings: wrap-around, backpressure that loses nothing, and contacts merged and counted when their ring is full.
#include <gmock/gmock.h>

#include "common/exchange/segment_impl.h"
#include "tests/common/exchange/support.h"

namespace ballast::exchange::testing {
namespace {

using ::testing::HasSubstr;

/// Length and content of the probe frame of a step: lengths that share no factor with the ring's size.
std::vector<double> probe_values(std::uint64_t step) {
  std::vector<double> values(step * 7 % 97);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = content(step, i, 0);
  return values;
}
std::string warning_text(std::uint64_t step) { return std::string(step % 31, 'w') + std::to_string(step); }

/// Counters start shortly before 2^32, so that they overflow on the way.
TEST(report_ring, keeps_every_byte_of_a_writer_that_outruns_its_reader) {
  constexpr std::uint64_t kFrames = 20'000;
  SegmentPlan plan = plan_of(1);
  plan.report_bytes = 4096;
  plan.fluid = false;
  auto segment = Segment::create(Segment::make_name(), plan);
  ASSERT_TRUE(segment);
  RingCounters& ring = segment->impl().header().rigid_reports;
  ring.head = ring.tail = 0xffff'8000u;
  const std::string name = segment->name();
  Child writer([&] {
    auto mine = Segment::attach(name, Role::kRigid);
    if (!mine) return fail(mine.error());
    Link link(*mine, Role::kRigid);
    for (std::uint64_t step = 1; step <= kFrames; ++step) {
      auto sent = step % 2 ? link.frame(FrameKind::kProbes, step, 0.5, probe_values(step))
                           : link.warning(step, 0.5, warning_text(step));
      if (!sent) return fail(sent.error());
    }
    if (link.blocked_reports() == 0) return fail("the ring was never full: this test had no power");
    return link.finish(kFine, "") ? 0 : 2;
  });
  Control control(*segment);
  std::vector<Frame> frames;
  std::uint64_t step = 0;
  while (step < kFrames) {
    control.wait_for_news(std::chrono::milliseconds(1000));
    frames.clear();
    auto drained = control.drain(Role::kRigid, frames);
    ASSERT_TRUE(drained) << drained.error().text();
    if (frames.empty()) {
      ASSERT_NE(control.state(Role::kRigid), PeerState::kDead);
    }
    for (const Frame& f : frames) {
      ASSERT_EQ(f.head.step, ++step);
      if (step % 2) {
        const auto wanted = probe_values(step);
        ASSERT_TRUE(same<double>(f.values(), wanted));
      } else {
        ASSERT_EQ(f.text(), warning_text(step));
      }
    }
  }
  EXPECT_EQ(writer.wait(), 0);
}

TEST(report_ring, refuses_what_can_never_fit) {
  SegmentPlan plan = plan_of(1);
  plan.report_bytes = 4096;
  auto segment = Segment::create(Segment::make_name(), plan);
  auto mine = Segment::attach(segment->name(), Role::kFluid);
  ASSERT_TRUE(mine);
  FluidLink link(*mine);
  const std::vector<double> values(509);  // 4072 bytes and a head of 24 fill it to the last byte
  EXPECT_TRUE(link.frame(FrameKind::kBodies, 1, 0, values));
  const std::vector<double> more(510);
  auto refused = link.frame(FrameKind::kBodies, 1, 0, more);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text(), HasSubstr("4104 bytes does not fit the ring of 4096"));
  std::vector<Frame> frames;
  EXPECT_TRUE(Control(*segment).drain(Role::kFluid, frames));
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].values().size(), 509u);
}

TEST(final_report, too_long_a_text_is_an_error_and_not_a_torn_text) {
  auto segment = Segment::create(Segment::make_name(), plan_of(1));
  auto mine = Segment::attach(segment->name(), Role::kFluid);
  ASSERT_TRUE(mine);
  FluidLink link(*mine);
  EXPECT_FALSE(link.finish(kFine, std::string(4097, 'x')));
  Control control(*segment);
  EXPECT_EQ(control.state(Role::kFluid), PeerState::kFinished);
  EXPECT_EQ(control.exit_code(Role::kFluid), kProcessFailed);
  EXPECT_EQ(control.final_report(Role::kFluid), "");
}

class ContactRing : public ::testing::Test {
 protected:
  ContactRing()
      : segment([] {
          SegmentPlan plan = plan_of(3);
          plan.contact_bytes = 1;  // the least there is: 4096 bytes, 42 contacts
          return Segment::create(Segment::make_name(), plan);
        }()),
        fluid_side(Segment::attach(segment->name(), Role::kFluid)),
        rigid_side(Segment::attach(segment->name(), Role::kRigid)),
        fluid(*fluid_side),
        rigid(*rigid_side) {
    std::vector<BodyState> states(3);
    fill(states, 0);
    EXPECT_TRUE(rigid.send({}, states));
    EXPECT_TRUE(fluid.receive(0, 0, states));
  }
  Order pass(std::span<const Contact> sent) {
    std::vector<Wrench> wrenches(3);
    std::vector<BodyState> states(3);
    fill(states, 0);
    EXPECT_TRUE(fluid.send(order_of(++step), wrenches, sent));
    auto order = rigid.receive(wrenches, got);
    EXPECT_TRUE(order) << order.error().text();
    EXPECT_TRUE(rigid.send(answer_of(step), states));
    EXPECT_TRUE(fluid.receive(step, 0, states));
    return *order;
  }
  Result<Segment> segment, fluid_side, rigid_side;
  FluidLink fluid;
  RigidLink rigid;
  std::vector<Contact> got;
  std::uint64_t step = 0;
};

TEST_F(ContactRing, passes_as_many_contacts_as_fit_unchanged) {
  for (int round = 0; round < 100; ++round) {  // 42 * 96 bytes: the start moves by 64 bytes back each time
    std::vector<Contact> sent(42);
    fill(sent, step, 3);
    const Order order = pass(sent);
    EXPECT_EQ(order.contacts_lost, 0u);
    ASSERT_TRUE(same<Contact>(got, sent));
  }
}

TEST_F(ContactRing, merges_per_body_what_does_not_fit_and_counts_it) {
  std::vector<Contact> sent(43);
  fill(sent, 1, 2);  // bodies 0 and 1; body 2 is dry
  for (Contact& c : sent) {
    for (int k = 0; k < 3; ++k) c.normal[k] = c.body == 0 ? (k == 2) : (k == 0 ? 0.6 : k == 1 ? 0.8 : 0);
  }
  const Order order = pass(sent);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(order.contacts, 2u);
  EXPECT_EQ(order.contacts_lost, 41u);
  EXPECT_EQ(fluid.contacts_merged(), 41u);
  for (std::uint32_t body = 0; body < 2; ++body) {
    double area = 0, moment[3] = {}, force[3] = {}, depth = -1e300;
    std::uint32_t samples = 0;
    for (const Contact& c : sent) {
      if (c.body != body) continue;
      area += c.area, samples += c.samples, depth = std::max(depth, c.depth);
      for (int k = 0; k < 3; ++k) moment[k] += c.area * c.position[k], force[k] += c.force[k];
    }
    EXPECT_EQ(got[body].body, body);
    EXPECT_EQ(got[body].samples, samples);
    EXPECT_DOUBLE_EQ(got[body].depth, depth);
    EXPECT_NEAR(got[body].area, area, 1e-12 * area);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(got[body].position[k], moment[k] / area, 1e-13);
      EXPECT_NEAR(got[body].force[k], force[k], 1e-13);
    }
  }
  EXPECT_NEAR(got[0].normal[2], 1, 1e-14);
  EXPECT_NEAR(got[1].normal[1], 0.8, 1e-14);
  EXPECT_EQ(pass({}).contacts_lost, 41u) << "a running total";
}

}  // namespace
}  // namespace ballast::exchange::testing
