// Frames become messages with the right numbers in the right fields, in chunks that fit one datagram.
#include <gtest/gtest.h>

#include <cmath>

#include "launch/publish_messages.h"
#include "tests/monitor/frames.h"

namespace ballast::monitor::testing {
namespace {

using launch::MessageFacts;

constexpr int kDatagram = 60000;  // bytes

MessageFacts facts_with(std::size_t moving) {
  MessageFacts facts{"drop", 2, true, {}, {}};
  facts.bodies = {"tank", std::string(63, 'n')};  // the longest name that the protocol allows
  for (std::size_t i = 0; i < moving; ++i) facts.moving.push_back(std::string(60, 'n') + std::to_string(i));
  return facts;
}

TEST(Messages, OfBodiesAndWrenchesHoldTheColumnsOfBodiesCsv) {
  const MessageFacts facts = MessageFacts::of(prepared_scene());
  const auto bodies = launch::body_messages(facts, bodies_frame(1), 3);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies[0].time, 0.25);
  EXPECT_EQ(bodies[0].step, 7);
  EXPECT_EQ(bodies[0].frame, 3);
  ASSERT_EQ(bodies[0].count, 1);
  const body_state_t& b = bodies[0].bodies[0];
  EXPECT_EQ(b.name, "ball");
  EXPECT_EQ(b.position[2], 2);
  EXPECT_EQ(b.orientation[0], 3);
  EXPECT_EQ(b.velocity[0], 7);
  EXPECT_EQ(b.angular_velocity[0], 10);
  EXPECT_EQ(b.acceleration[2], 15);
  const auto wrenches = launch::wrench_messages(facts, bodies_frame(1), 3);
  EXPECT_EQ(wrenches[0].wrenches[0].force[0], 16);
  EXPECT_EQ(wrenches[0].wrenches[0].torque[2], 21);
}

/// Every list, cut: each part below a datagram, none lost, none twice, numbered.
template <class Message, class Size>
void expect_whole(const std::vector<Message>& chunks, std::size_t entries, Size&& size) {
  std::size_t sum = 0;
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    EXPECT_LT(chunks[c].getEncodedSize(), kDatagram);
    EXPECT_EQ(chunks[c].chunk, static_cast<int>(c));
    EXPECT_EQ(chunks[c].chunks, static_cast<int>(chunks.size()));
    EXPECT_EQ(chunks[c].frame, 5);
    EXPECT_EQ(size(chunks[c]), static_cast<std::size_t>(chunks[c].count));
    sum += size(chunks[c]);
  }
  EXPECT_EQ(sum, entries);
}

TEST(Messages, OfLongListsComeInChunksOfOneDatagram) {
  const MessageFacts facts = facts_with(1000);
  expect_whole(launch::body_messages(facts, bodies_frame(1000), 5), 1000, [](auto& m) { return m.bodies.size(); });
  expect_whole(launch::wrench_messages(facts, bodies_frame(1000), 5), 1000, [](auto& m) { return m.wrenches.size(); });
  expect_whole(launch::contact_messages(facts, contacts_frame(1001), 5), 1001,
               [](auto& m) { return m.contacts.size(); });
  expect_whole(launch::particle_messages(particles_frame(5000), 5), 5000, [](auto& m) { return m.x.size(); });
  expect_whole(launch::contact_messages(facts, contacts_frame(0), 5), 0, [](auto& m) { return m.contacts.size(); });
}

TEST(Messages, OfParticlesSayHowTheyWereThinned) {
  const auto chunks = launch::particle_messages(particles_frame(2000), 0);
  ASSERT_EQ(chunks.size(), 2u);
  for (const particles_t& m : chunks) {
    EXPECT_EQ(m.particles, 20000);
    EXPECT_EQ(m.every, 10);
    EXPECT_EQ(m.shown, 2000);
  }
  EXPECT_EQ(chunks[1].id[0], 18000);  // the 1800 before it are in the first chunk
  EXPECT_EQ(chunks[1].y[0], -1800);
  EXPECT_EQ(chunks[1].vz[0], 3);
  EXPECT_EQ(chunks[1].pressure[0], 1800);
}

TEST(Messages, OfContactsNameTheBodyEvenIfItDoesNotExist) {
  Frame frame = contacts_frame(1);
  exchange::Contact stray{};
  stray.body = 77;
  append(frame, stray);
  const auto chunks = launch::contact_messages(facts_with(1), frame, 0);
  EXPECT_EQ(chunks[0].contacts[0].body, std::string(63, 'n'));
  EXPECT_EQ(chunks[0].contacts[1].body, "?");
}

TEST(Messages, OfTheFluidHoldItsStatistics) {
  const fluid_statistics_t m = launch::fluid_message(fluid_frame());
  EXPECT_EQ(m.mass, 240);
  EXPECT_EQ(m.particles, 3750);
  EXPECT_EQ(m.pressure_time, 3);
  EXPECT_EQ(m.wait_time, 1);
  EXPECT_EQ(m.step_limit, "sound");
}

TEST(Messages, OfTheStatusHoldTheErrorsSoFarAndNoNumberWhereThereIsNone) {
  launch::RealTimeFactor speed;
  launch::RunStatus status;
  status.errors = {.density_mean = 0.003,
                   .density_max = 0.2,
                   .pressure = 1e-4,
                   .interface = 0.5,
                   .mass = -0.01,
                   .momentum = 2e-16,
                   .energy = 0.02};
  const status_t all = launch::status_message(facts_with(1), status, "sound", speed);
  EXPECT_EQ(all.density_error_mean, 0.003);
  EXPECT_EQ(all.density_error_max, 0.2);
  EXPECT_EQ(all.pressure_residual, 1e-4);
  EXPECT_EQ(all.interface_residual, 0.5);
  EXPECT_EQ(all.mass_drift, -0.01);
  EXPECT_EQ(all.momentum_imbalance, 2e-16);
  EXPECT_EQ(all.energy_gain, 0.02);
  status.errors = {};
  const status_t none = launch::status_message(facts_with(1), status, "sound", speed);
  EXPECT_EQ(none.density_error_mean, 0);
  EXPECT_TRUE(std::isnan(none.mass_drift));
  EXPECT_TRUE(std::isnan(none.momentum_imbalance));
  EXPECT_TRUE(std::isnan(none.energy_gain));
}

TEST(Messages, RealTimeFactorIsThatOfTheLastSecondsNotOfTheWholeRun) {
  launch::RealTimeFactor speed;
  double factor = 0;
  for (int i = 1; i <= 100; ++i) factor = speed.update(0.01 * i, 0.1 * i);  // 10 s of wall time at 0.1
  EXPECT_NEAR(factor, 0.1, 1e-12);
  for (int i = 1; i <= 30; ++i) factor = speed.update(1 + 0.05 * i, 10 + 0.1 * i);  // 3 s at 0.5
  EXPECT_NEAR(factor, 0.5, 1e-12);
}

}  // namespace
}  // namespace ballast::monitor::testing
