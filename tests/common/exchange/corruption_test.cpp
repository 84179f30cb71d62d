// What a peer writes is not trusted: every field that can be wrong is made wrong, and the error must name it.
#include <gmock/gmock.h>

#include <limits>

#include "common/exchange/segment_impl.h"
#include "tests/common/exchange/support.h"

namespace ballast::exchange::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// Both links in this process; messages can be changed in the shared memory between sending and receiving.
class Corruption : public ::testing::Test {
 protected:
  Corruption()
      : segment(Segment::create(Segment::make_name(), plan_of(3))),
        fluid_side(Segment::attach(segment->name(), Role::kFluid)),
        rigid_side(Segment::attach(segment->name(), Role::kRigid)),
        fluid(*fluid_side),
        rigid(*rigid_side) {
    fill(states, 0);
    fill(wrenches, 1);
  }
  template <class T>
  T& shared(Part part, std::size_t offset = 0) {
    return *reinterpret_cast<T*>(segment->impl().base() + segment->impl().block(part).offset + offset);
  }
  Order& order() { return shared<Order>(Part::kOrder); }
  Answer& answer() { return shared<Answer>(Part::kAnswer); }
  Wrench& wrench(std::size_t body) { return shared<Wrench>(Part::kOrder, sizeof(Order) + body * sizeof(Wrench)); }
  BodyState& state(std::size_t body) {
    return shared<BodyState>(Part::kAnswer, sizeof(Answer) + body * sizeof(BodyState));
  }
  /// One good step, then an answer to step 2 that `damage` changes; gives the fluid's error.
  Error after_damaged_answer(const std::function<void()>& damage) {
    EXPECT_TRUE(rigid.send({}, states));
    EXPECT_TRUE(fluid.receive(0, 0, states));
    for (std::uint64_t step = 1; step <= 2; ++step) {
      EXPECT_TRUE(fluid.send(order_of(step), wrenches, {}));
      EXPECT_TRUE(rigid.receive(got, contacts));
      EXPECT_TRUE(rigid.send(answer_of(step), states));
      if (step == 2) damage();
      auto result = fluid.receive(step, 0, states);
      if (!result) return result.error();
    }
    return {"nothing was noticed", "", "", 0};
  }
  Error after_damaged_order(const std::function<void()>& damage, std::span<const Contact> sent = {}) {
    EXPECT_TRUE(rigid.send({}, states));
    EXPECT_TRUE(fluid.receive(0, 0, states));
    for (std::uint64_t step = 1; step <= 2; ++step) {
      EXPECT_TRUE(fluid.send(order_of(step), wrenches, sent));
      if (step == 2) damage();
      auto result = rigid.receive(got, contacts);
      if (!result) return result.error();
      EXPECT_TRUE(rigid.send(answer_of(step), states));
      EXPECT_TRUE(fluid.receive(step, 0, states));
    }
    return {"nothing was noticed", "", "", 0};
  }
  Result<Segment> segment, fluid_side, rigid_side;
  FluidLink fluid;
  RigidLink rigid;
  std::vector<BodyState> states = std::vector<BodyState>(3);
  std::vector<Wrench> wrenches = std::vector<Wrench>(3), got = wrenches;
  std::vector<Contact> contacts;
};

#define EXPECT_NAMES(call, ...)                                    \
  do {                                                             \
    const Error e = call;                                          \
    EXPECT_EQ(e.exit_code, kProcessFailed);                        \
    EXPECT_THAT(e.text(), AllOf(HasSubstr("(pid "), __VA_ARGS__)); \
  } while (false)

TEST_F(Corruption, undamaged_messages_pass) {
  EXPECT_EQ(after_damaged_answer([] {}).what, "nothing was noticed");
}
TEST_F(Corruption, answer_to_another_step) {
  EXPECT_NAMES(after_damaged_answer([&] { answer().step = 7; }), HasSubstr("the rigid process"),
               HasSubstr("step = 7, expected 2"));
}
TEST_F(Corruption, answer_to_another_iteration) {
  EXPECT_NAMES(after_damaged_answer([&] { answer().iteration = 1; }), HasSubstr("iteration = 1, expected 0"));
}
TEST_F(Corruption, answer_with_a_wrong_count) {
  EXPECT_NAMES(after_damaged_answer([&] { answer().bodies = 2; }), HasSubstr("bodies = 2, expected 3"));
}
TEST_F(Corruption, answer_without_a_time) {
  EXPECT_NAMES(after_damaged_answer([&] { answer().time = kNan; }), HasSubstr("time = nan"));
}
TEST_F(Corruption, answer_with_a_negative_bound) {
  EXPECT_NAMES(after_damaged_answer([&] { answer().max_dt = -1; }), HasSubstr("max_dt = -1"));
}
TEST_F(Corruption, orientation_that_is_no_rotation) {
  EXPECT_NAMES(after_damaged_answer([&] {
                 for (double& q : state(2).orientation) q = 0.6;
               }),
               HasSubstr("orientation of body 2 (crate2) = length 1.2"));
}
TEST_F(Corruption, message_number_that_skips_one) {
  EXPECT_NAMES(after_damaged_answer([&] { segment->impl().header().answer.sequence += 1; }), HasSubstr("sequence = 4"));
}

/// Every one of the 61 numbers of a state, with each kind of bad value.
TEST_F(Corruption, every_number_of_a_state_is_checked) {
  const struct {
    const char* name;
    int first, count;
  } fields[] = {{"position", 0, 3},      {"orientation", 3, 4},        {"velocity", 7, 3},  {"angular_velocity", 10, 3},
                {"acceleration", 13, 6}, {"free_acceleration", 19, 6}, {"mobility", 25, 36}};
  ASSERT_TRUE(rigid.send({}, states));
  ASSERT_TRUE(fluid.receive(0, 0, states));
  std::uint64_t step = 0;
  int checked = 0;
  std::vector<BodyState> sink(3);
  for (const auto& f : fields) {
    for (int i = 0; i < f.count; ++i, ++checked) {
      const double bad = std::array{kNan, kInf, -kInf}[static_cast<std::size_t>(checked % 3)];
      ASSERT_TRUE(fluid.send(order_of(++step), wrenches, {}));
      ASSERT_TRUE(rigid.receive(got, contacts));
      ASSERT_TRUE(rigid.send(answer_of(step), states));
      reinterpret_cast<double*>(&state(1))[f.first + i] = bad;
      auto result = fluid.receive(step, 0, sink);
      ASSERT_FALSE(result) << f.name << i;
      EXPECT_THAT(result.error().what,
                  HasSubstr(" sent " + std::string(f.name) + "[" + std::to_string(i) + "] of body 1 (crate1) = "));
    }
  }
  EXPECT_EQ(checked, 61);
}

TEST_F(Corruption, order_for_another_step) {
  EXPECT_NAMES(after_damaged_order([&] { order().step = 4; }), HasSubstr("the fluid process"),
               HasSubstr("step = 4, expected 2"));
}
TEST_F(Corruption, order_that_goes_back_without_saying_so) {
  EXPECT_NAMES(after_damaged_order([&] { order().step = 1; }), HasSubstr("step = 1, expected 2"));
}
TEST_F(Corruption, repetition_without_roll_back) {
  EXPECT_NAMES(after_damaged_order([&] { order().step = 1, order().iteration = 1; }), HasSubstr("flags = 0"));
}
TEST_F(Corruption, repetition_that_skips_one) {
  EXPECT_NAMES(after_damaged_order([&] { order().step = 1, order().iteration = 2, order().flags = kRollBack; }),
               HasSubstr("iteration = 2, expected 1"));
}
TEST_F(Corruption, unknown_flags) {
  EXPECT_NAMES(after_damaged_order([&] { order().flags = 64; }), HasSubstr("flags = 64"));
}
TEST_F(Corruption, bodies_that_move_in_a_step_asleep) {
  ASSERT_TRUE(rigid.send({}, states));
  ASSERT_TRUE(fluid.receive(0, 0, states));
  for (std::uint64_t step = 1; step <= 2; ++step) {
    ASSERT_TRUE(fluid.send(order_of(step, kAsleep), wrenches, {}));
    ASSERT_TRUE(rigid.receive(got, contacts));
    auto moved = states;
    if (step == 2) moved[1].position[2] += 1e-12;
    ASSERT_TRUE(rigid.send(answer_of(step), moved));
    auto answer = fluid.receive(step, 0, states);
    ASSERT_EQ(static_cast<bool>(answer), step == 1);
    if (step == 2) EXPECT_NAMES(answer.error(), HasSubstr("states in a step asleep"));
  }
}
TEST_F(Corruption, order_without_a_length) {
  EXPECT_NAMES(after_damaged_order([&] { order().dt = 0; }), HasSubstr("dt = 0, expected a positive number"));
}
TEST_F(Corruption, order_with_an_endless_length) {
  EXPECT_NAMES(after_damaged_order([&] { order().dt = kInf; }), HasSubstr("dt = inf"));
}
TEST_F(Corruption, order_with_a_wrong_count) {
  EXPECT_NAMES(after_damaged_order([&] { order().bodies = 4; }), HasSubstr("bodies = 4, expected 3"));
}
TEST_F(Corruption, infinite_torque) {
  EXPECT_NAMES(after_damaged_order([&] { wrench(0).torque[2] = -kInf; }),
               HasSubstr("torque[2] of body 0 (crate0) = -inf"));
}
TEST_F(Corruption, more_contacts_announced_than_written) {
  EXPECT_NAMES(after_damaged_order([&] { order().contacts = 1'000'000; }), HasSubstr("contacts = 1000000"));
}
TEST_F(Corruption, contact_of_a_body_that_does_not_exist) {
  const std::vector<Contact> one(1);
  EXPECT_NAMES(after_damaged_order([&] { shared<Contact>(Part::kContacts, sizeof(Contact)).body = 3; }, one),
               HasSubstr("body of contact 0 = 3, expected an index below 3"));
}
TEST_F(Corruption, contact_with_no_number_for_its_depth) {
  const std::vector<Contact> one(1);
  EXPECT_NAMES(after_damaged_order([&] { shared<Contact>(Part::kContacts, sizeof(Contact)).depth = kNan; }, one),
               HasSubstr("depth of body 0 (crate0) = nan"));
}
TEST_F(Corruption, contact_counter_of_the_reader) {
  ASSERT_TRUE(rigid.send({}, states));
  ASSERT_TRUE(fluid.receive(0, 0, states));
  segment->impl().header().contacts.tail = 12345;
  EXPECT_NAMES(fluid.send(order_of(1), wrenches, {}).error(), HasSubstr("tail of the contact ring"));
}

/// The coordinator's reading of reports.
class Reports : public Corruption {
 protected:
  FrameHead& first_frame() { return shared<FrameHead>(Part::kFluidReports); }
  Error after_damage(const std::function<void()>& damage) {
    EXPECT_TRUE(fluid.report(report_of(9)));
    damage();
    std::vector<Frame> frames;
    auto result = Control(*segment).drain(Role::kFluid, frames);
    return result ? Error{"nothing was noticed", "", "", 0} : result.error();
  }
};
TEST_F(Reports, kind_that_does_not_exist) {
  EXPECT_NAMES(after_damage([&] { first_frame().kind = static_cast<FrameKind>(9); }),
               HasSubstr("kind of a report = 9"));
}
TEST_F(Reports, size_that_does_not_fit_the_kind) {
  EXPECT_NAMES(after_damage([&] { first_frame().bytes = 8; }), HasSubstr("bytes of a report = 8"));
}
TEST_F(Reports, size_beyond_what_was_written) {
  EXPECT_NAMES(after_damage([&] { first_frame().kind = FrameKind::kBodies, first_frame().bytes = 4096; }),
               HasSubstr("bytes of a report = 4096"));
}
TEST_F(Reports, size_near_the_top_of_32_bits_does_not_wrap) {
  EXPECT_NAMES(after_damage([&] { first_frame().kind = FrameKind::kWarning, first_frame().bytes = 0xffffffff; }),
               HasSubstr("bytes of a report = 4294967295"));
}
TEST_F(Reports, time_that_is_no_number) {
  EXPECT_NAMES(after_damage([&] { first_frame().time = kNan; }), HasSubstr("time of a report"));
}
TEST_F(Reports, counter_beyond_the_ring) {
  EXPECT_NAMES(after_damage([&] { segment->impl().header().fluid_reports.head = 0x80000000; }),
               HasSubstr("head of the report ring"));
}
TEST_F(Reports, part_of_a_frame) {
  EXPECT_NAMES(after_damage([&] { segment->impl().header().fluid_reports.head = 16; }),
               HasSubstr("bytes in the report ring = 16"));
}

}  // namespace
}  // namespace ballast::exchange::testing
