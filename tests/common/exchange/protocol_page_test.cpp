// The protocol page must be true: its tables equal the code's layout, and a program written from it alone works.
#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "common/exchange/hash.h"
#include "common/exchange/layout.h"
#include "tests/common/exchange/support.h"

namespace ballast::exchange::testing {
namespace {

using ::testing::HasSubstr;

std::string page() {
  std::ifstream file(BALLAST_SOURCE_DIR "/common/exchange/README.md");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

const std::map<std::string, std::size_t> kSizes = {{"Header", sizeof(Header)},
                                                   {"Block", sizeof(Block)},
                                                   {"PeerLine", sizeof(PeerLine)},
                                                   {"Mailbox", sizeof(Mailbox)},
                                                   {"RingCounters", sizeof(RingCounters)},
                                                   {"WorldRecord", sizeof(WorldRecord)},
                                                   {"BodyRecord", sizeof(BodyRecord)},
                                                   {"ShapeRecord", sizeof(ShapeRecord)},
                                                   {"JointRecord", sizeof(JointRecord)},
                                                   {"BodyState", sizeof(BodyState)},
                                                   {"Wrench", sizeof(Wrench)},
                                                   {"Contact", sizeof(Contact)},
                                                   {"Order", sizeof(Order)},
                                                   {"Answer", sizeof(Answer)},
                                                   {"StepReport", sizeof(StepReport)},
                                                   {"FluidStatistics", sizeof(FluidStatistics)},
                                                   {"ParticleSetHead", sizeof(ParticleSetHead)},
                                                   {"ParticleSample", sizeof(ParticleSample)},
                                                   {"Command", sizeof(Command)},
                                                   {"CommandResult", sizeof(CommandResult)},
                                                   {"CheckpointPart", sizeof(CheckpointPart)},
                                                   {"FrameHead", sizeof(FrameHead)}};

TEST(layout, has_no_field_that_the_table_forgets) {
  std::map<std::string, std::size_t> end;
  const std::map<std::string, bool> has_gaps = {
      {"Header", true}, {"PeerLine", true}, {"Mailbox", true}, {"RingCounters", true}};
  for (const LayoutField& f : layout_fields()) {
    const std::string record(f.record);
    if (!has_gaps.contains(record)) {
      EXPECT_EQ(f.offset, end[record]) << record << " " << f.field;
    }
    EXPECT_GE(f.offset, end[record]) << record << " " << f.field;
    end[record] = f.offset + f.bytes;
  }
  ASSERT_EQ(end.size(), kSizes.size());
  for (const auto& [record, size] : kSizes) {
    EXPECT_LE(end[record], size);
    if (!has_gaps.contains(record)) {
      EXPECT_EQ(end[record], size) << record;
    }
  }
}

TEST(layout, keeps_every_writer_on_lines_of_its_own) {
  // What different processes write must never share 128 bytes.
  const std::size_t alone[] = {offsetof(Header, peers),
                               offsetof(Header, peers) + 128,
                               offsetof(Header, peers) + 256,
                               offsetof(Header, order),
                               offsetof(Header, answer),
                               offsetof(Header, contacts),
                               offsetof(Header, contacts) + 128,
                               offsetof(Header, fluid_reports),
                               offsetof(Header, fluid_reports) + 128,
                               offsetof(Header, rigid_reports),
                               offsetof(Header, rigid_reports) + 128,
                               offsetof(Header, commands),
                               offsetof(Header, commands) + 128,
                               offsetof(Header, granted),
                               offsetof(Header, gate),
                               offsetof(Header, news)};
  for (std::size_t i = 0; i < std::size(alone); ++i) {
    EXPECT_EQ(alone[i] % 128, 0u);
    if (i > 0) {
      EXPECT_GE(alone[i], alone[i - 1] + 128);
    }
  }
}

TEST(protocol_page, prints_the_offsets_sizes_and_hash_of_the_code) {
  std::istringstream lines(page());
  const std::regex title(R"(#### `(\w+)`, (\d+) bytes.*)"), row(R"(\| (\d+) \| (\d+) \| `(\w+)` \|.*)");
  std::vector<std::string> printed, actual;
  std::size_t records = 0;
  std::string line, record;
  for (std::smatch m; std::getline(lines, line);) {
    if (std::regex_match(line, m, title)) {
      record = m[1];
      ++records;
      ASSERT_TRUE(kSizes.contains(record)) << record;
      EXPECT_EQ(std::stoul(m[2]), kSizes.at(record)) << record;
    } else if (std::regex_match(line, m, row)) {
      printed.push_back(record + "." + m[3].str() + " at " + m[1].str() + ": " + m[2].str());
    }
  }
  for (const LayoutField& f : layout_fields()) {
    actual.push_back(std::string(f.record) + "." + std::string(f.field) + " at " + std::to_string(f.offset) + ": " +
                     std::to_string(f.bytes));
  }
  EXPECT_EQ(records, kSizes.size());
  EXPECT_EQ(printed, actual);
  char hash[64];
  std::snprintf(hash, sizeof hash, "Version %u, layout hash 0x%016llx", kProtocolVersion,
                static_cast<unsigned long long>(layout_hash()));
  EXPECT_THAT(page(), HasSubstr(hash));
}

TEST(protocol_page, numbers_the_parts_as_the_code_does) {
  const std::regex row(R"(\n\| (\d+) \| [a-z' ]+ \| )");
  const std::string text = page();
  std::size_t next = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it) {
    EXPECT_EQ(std::stoul((*it)[1]), next++);
  }
  EXPECT_EQ(next, kParts);
}

/// A rigid process in another language, written from the page: 60 steps, every third one repeated, and one slept
/// through.
TEST(protocol_page, is_enough_to_write_a_rigid_process_in_another_language) {
  SegmentPlan plan = plan_of(3);
  for (BodyRecord& b : plan.manifest.bodies) b.mass = 2.5;
  plan.manifest.bodies[1].velocity[0] = 0.25;
  auto segment = Segment::create(Segment::make_name(), plan);
  ASSERT_TRUE(segment);
  const std::string name = segment->name();
  Child python([&] {
    ::execlp("python3", "python3", BALLAST_SOURCE_DIR "/tests/common/exchange/foreign_rigid.py", name.c_str(), nullptr);
    return 127;
  });
  auto mine = Segment::attach(name, Role::kFluid);
  ASSERT_TRUE(mine);
  FluidLink link(*mine);
  std::vector<BodyState> states(3), before;
  std::vector<Wrench> wrenches(3);
  auto first = link.receive(0, 0, states);
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_EQ(states[1].velocity[0], 0.25);
  std::uint64_t hash = 0;
  std::array<double, 4> given{};  // impulse and the sum of its magnitudes, of what is kept
  const auto give = [&](double dt) {
    for (const Wrench& w : wrenches) {
      for (std::size_t k = 0; k < 3; ++k) given[k] += dt * w.force[k];
      given[3] += dt * std::hypot(w.force[0], w.force[1], w.force[2]);
    }
  };
  for (std::uint64_t step = 1; step <= 60; ++step) {
    before = states;
    for (std::uint32_t iteration = 0; iteration < (step % 3 == 0 ? 2u : 1u); ++iteration) {
      fill(wrenches, step + iteration);
      std::vector<Contact> contacts(step % 5);
      fill(contacts, step, 3);
      Order order = order_of(step, iteration ? kRollBack : 0u, iteration);
      order.dt = 0.01 + 0.001 * iteration;
      ASSERT_TRUE(link.send(order, wrenches, contacts));
      auto answer = link.receive(step, iteration, states);
      ASSERT_TRUE(answer) << answer.error().text();
      EXPECT_EQ(answer->hash, state_hash(states));
      hash = answer->hash;
      for (std::size_t b = 0; b < 3; ++b) {
        for (int k = 0; k < 3; ++k) {
          const double v = before[b].velocity[k] + order.dt * ((k == 2 ? -9.81 : 0) + wrenches[b].force[k] / 2.5);
          EXPECT_EQ(states[b].velocity[k], v) << "step " << step << " body " << b;
          EXPECT_EQ(states[b].position[k], before[b].position[k] + order.dt * v);
        }
      }
    }
    give(step % 3 == 0 ? 0.011 : 0.01);
  }
  const Order last = order_of(61, kAsleep);
  ASSERT_TRUE(link.send(last, wrenches, {}));
  give(last.dt);
  auto asleep = link.receive(61, 0, states);
  ASSERT_TRUE(asleep) << asleep.error().text();
  EXPECT_EQ(asleep->hash, hash) << "bodies that sleep do not move";
  ASSERT_TRUE(link.finish(kFine, "{}"));
  EXPECT_EQ(python.wait(), 0);
  Control control(*segment);
  std::vector<Frame> frames;
  ASSERT_TRUE(control.drain(Role::kRigid, frames));
  ASSERT_EQ(frames.size(), 61u);
  EXPECT_EQ(frames.back().step_report().hash, hash);
  EXPECT_EQ(frames[2].step_report().iteration, 1u);
  const StepReport end = frames.back().step_report();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(end.impulse[k], given[k], 1e-12 * given[3]);
  EXPECT_NEAR(end.impulse_scale, given[3], 1e-12 * given[3]);
  EXPECT_EQ(control.final_report(Role::kRigid), "{\"engine\": \"foreign_rigid.py\"}");
}

}  // namespace
}  // namespace ballast::exchange::testing
