// Frames for monitors: they arrive whole, never make their writer wait, and leave reports half of the ring.
#include <gmock/gmock.h>

#include "common/exchange/segment_impl.h"
#include "tests/common/exchange/support.h"

namespace ballast::exchange::testing {
namespace {

using ::testing::HasSubstr;

struct MonitorFrames : ::testing::Test {
  Result<Segment> segment = Segment::create(Segment::make_name(), [] {
    SegmentPlan plan = plan_of(2);
    plan.report_bytes = 1 << 14;
    plan.monitor = monitor_bit(FrameKind::kContacts);
    return plan;
  }());
  Link link{*segment, Role::kFluid};
  Control control{*segment};

  Status drain(std::vector<Frame>& frames) { return control.drain(Role::kFluid, frames); }
};

TEST_F(MonitorFrames, are_asked_for_in_the_header_kind_by_kind) {
  EXPECT_EQ(segment->impl().header().monitor, 1u << 5);  // contacts are kind 5 on the protocol page
  EXPECT_TRUE(segment->wants(FrameKind::kContacts));
  EXPECT_FALSE(segment->wants(FrameKind::kParticles));
  EXPECT_FALSE(segment->wants(FrameKind::kFluid));
}

TEST_F(MonitorFrames, arrive_as_they_were_written) {
  FluidStatistics statistics{};
  statistics.mass = 3.5;
  std::fill(std::begin(statistics.limit), std::end(statistics.limit), 'x');  // no zero at the end
  std::vector<Contact> contacts(3);
  fill(contacts, 7, 2);
  struct {
    ParticleSetHead head{100, 50, 2};
    ParticleSample samples[2] = {{0, {1, 2, 3}, {4, 5, 6}, 7}, {50, {8, 9, 10}, {11, 12, 13}, 14}};
  } set;
  link.offer(FrameKind::kFluid, 4, 0.5, std::as_bytes(std::span(&statistics, 1)));
  link.offer(FrameKind::kContacts, 4, 0.5, std::as_bytes(std::span(contacts)));
  link.offer(FrameKind::kParticles, 4, 0.5, std::as_bytes(std::span(&set, 1)));
  std::vector<Frame> frames;
  ASSERT_TRUE(drain(frames));
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].fluid().mass, 3.5);
  EXPECT_EQ(std::string(frames[0].fluid().limit), std::string(31, 'x'));
  EXPECT_TRUE(same<Contact>(frames[1].contacts(), contacts));
  EXPECT_EQ(frames[2].particle_head().every, 50u);
  ASSERT_EQ(frames[2].particles().size(), 2u);
  EXPECT_EQ(frames[2].particles()[1].pressure, 14);
  EXPECT_EQ(link.dropped_frames(), 0u);
}

TEST_F(MonitorFrames, are_dropped_and_counted_while_reports_still_find_room) {
  std::vector<Contact> contacts(20);
  fill(contacts, 1, 2);
  const auto bytes = std::as_bytes(std::span(contacts));
  const std::size_t frame = sizeof(FrameHead) + bytes.size(), fits = (1 << 13) / frame;  // half of the ring
  for (int i = 0; i < 100; ++i) link.offer(FrameKind::kContacts, 1, 0, bytes);
  EXPECT_EQ(link.dropped_frames(), 100 - fits);
  const std::size_t reports = (1 << 13) / (sizeof(FrameHead) + sizeof(StepReport));
  for (std::size_t i = 0; i < reports; ++i) ASSERT_TRUE(link.report(report_of(i + 1)));
  EXPECT_EQ(link.blocked_reports(), 0u) << "a report had to wait for room";
  std::vector<Frame> frames;
  ASSERT_TRUE(drain(frames));
  EXPECT_EQ(frames.size(), fits + reports);
  link.offer(FrameKind::kContacts, 2, 0, bytes);
  EXPECT_EQ(link.dropped_frames(), 100 - fits) << "there is room again";
}

TEST_F(MonitorFrames, of_a_wrong_size_end_the_run_with_their_field) {
  const std::byte few[24] = {};
  for (FrameKind kind : {FrameKind::kFluid, FrameKind::kContacts, FrameKind::kParticles}) {
    auto other = Segment::create(Segment::make_name(), plan_of(2));
    Link(*other, Role::kFluid).offer(kind, 1, 0, few);
    std::vector<Frame> frames;
    const Status drained = Control(*other).drain(Role::kFluid, frames);
    ASSERT_FALSE(drained) << static_cast<int>(kind);
    EXPECT_THAT(drained.error().what, HasSubstr("bytes of a report = 24"));
  }
}

}  // namespace
}  // namespace ballast::exchange::testing
