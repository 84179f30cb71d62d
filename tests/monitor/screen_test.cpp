// The text monitor's screen: what it says, and that it fits 80 x 24 whatever comes.
#include "monitor/screen.h"

#include <gmock/gmock.h>

#include <limits>

#include "msgs/channels.h"

namespace ballast::monitor {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

template <class Message>
void hear(View& view, const char* channel, const Message& message) {
  std::vector<std::byte> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  view.take(channel, bytes.data(), bytes.size());
}

status_t a_status() {
  status_t s{};
  s.scene = "dam";
  s.state = "running";
  s.time = 0.5;
  s.duration = 2;
  s.step = 900;
  s.dt = 5e-4;
  s.step_limit = "sound";
  s.wall = 10;
  s.real_time_factor = 0.04;
  s.real_time_factor_mean = 0.05;
  s.density_error_mean = 0.003;
  s.density_error_max = 0.2;
  s.interface_residual = 1.4;
  s.fluid_pid = 11;
  s.rigid_pid = 12;
  s.fluid_state = s.rigid_state = "running";
  s.fluid_compute = 9;
  s.fluid_wait = 1;
  s.rigid_compute = 2;
  s.rigid_wait = 8;
  return s;
}

std::string text(const View& view, double silent = 0) {
  std::string out;
  for (const std::string& line : view.lines(silent)) out += line + "\n";
  return out;
}

TEST(Screen, SaysHowTheRunStands) {
  View view;
  hear(view, msgs::kStatus, a_status());
  const std::string screen = text(view);
  for (const char* part : {"dam: running", "0.5000 of 2 s", "25.0 %", "0.04 x real time (mean 0.05)", "30 s left",
                           "900 of 0.5 ms, limited by sound", "fluid running (pid 11)", "rigid running (pid 12)",
                           "fluid computes 90 %, waits 10 %", "rigid computes 20 %, waits 80 %",
                           "density 0.3 % in the mean, 20 % at worst; interface 140 %", "warnings   none"}) {
    EXPECT_THAT(screen, HasSubstr(part));
  }
}

TEST(Screen, SaysWhichBalancesARunHas) {
  View view;
  status_t status = a_status();
  status.mass_drift = -0.00125;
  status.momentum_imbalance = 2.4e-16;
  status.energy_gain = 0.02;
  hear(view, msgs::kStatus, status);
  EXPECT_THAT(text(view), HasSubstr("\nbalance    mass -0.125 %; momentum 2e-16; energy gained 2 %\n"));
  status.momentum_imbalance = status.energy_gain = std::numeric_limits<double>::quiet_NaN();
  hear(view, msgs::kStatus, status);
  EXPECT_THAT(text(view), HasSubstr("\nbalance    mass -0.125 %\n"));
  status.mass_drift = status.energy_gain;  // before the first step
  hear(view, msgs::kStatus, status);
  EXPECT_THAT(text(view), Not(HasSubstr("balance")));
  status.fluid_state = "none";
  status.mass_drift = 0;
  hear(view, msgs::kStatus, status);
  EXPECT_THAT(text(view), Not(HasSubstr("balance")));
}

TEST(Screen, SaysThatARunSleeps) {
  View view;
  status_t status = a_status();
  status.step_limit = "asleep";
  status.dt = 0.02;
  hear(view, msgs::kStatus, status);
  EXPECT_THAT(text(view), HasSubstr("900 of 20 ms, asleep: all is at rest"));
}

TEST(Screen, ForgetsTheRunBefore) {
  View view;
  status_t status = a_status();
  hear(view, msgs::kStatus, status);
  body_states_t bodies{};
  bodies.count = 1;
  bodies.bodies.resize(1);
  bodies.bodies[0].name = "crate";
  hear(view, msgs::kBodies, bodies);
  ++status.step;
  hear(view, msgs::kStatus, status);
  EXPECT_THAT(text(view), HasSubstr("crate"));
  status.step = 0;
  hear(view, msgs::kStatus, status);
  EXPECT_THAT(text(view), Not(HasSubstr("crate")));
}

TEST(Screen, ShowsBodiesWithTheirForces) {
  View view;
  hear(view, msgs::kStatus, a_status());
  body_states_t bodies{};
  bodies.count = 1;
  bodies.bodies.resize(1);
  bodies.bodies[0].name = "crate";
  bodies.bodies[0].position[2] = 0.75;
  bodies.bodies[0].velocity[0] = 3;
  bodies.bodies[0].velocity[1] = 4;
  wrenches_t wrenches{};
  wrenches.count = 1;
  wrenches.wrenches.resize(1);
  wrenches.wrenches[0].body = "crate";
  wrenches.wrenches[0].force[2] = -12.5;
  hear(view, msgs::kBodies, bodies);
  EXPECT_THAT(text(view), HasSubstr("    0.7500    5.0000          -"));  // z, speed, no force yet
  hear(view, msgs::kWrenches, wrenches);
  EXPECT_THAT(text(view), HasSubstr("    0.7500    5.0000       12.5          0"));
}

TEST(Screen, FitsWhateverComes) {
  View view;
  status_t status = a_status();
  status.scene = std::string(500, 's');
  status.step_limit = "\033[2J\n" + std::string(100, 'x');
  status.warnings = 1;
  hear(view, msgs::kStatus, status);
  hear(view, msgs::kFluid, fluid_statistics_t{});
  hear(view, msgs::kParticles, particles_t{});
  body_states_t bodies{};
  bodies.count = 200;
  bodies.bodies.resize(200);
  for (std::size_t i = 0; i < 200; ++i) bodies.bodies[i].name = std::string(63, 'b') + std::to_string(i);
  hear(view, msgs::kBodies, bodies);
  warning_t warning{};
  for (int i = 0; i < 40; ++i) warning.text += "pressure über alles ";
  hear(view, msgs::kWarning, warning);
  const auto lines = view.lines(0);
  EXPECT_EQ(lines.size(), kLines);
  for (const std::string& line : lines) {
    const auto columns = std::ranges::count_if(line, [](char c) { return (c & 0xc0) != 0x80; });
    EXPECT_LE(columns, static_cast<long>(kColumns)) << line;
    EXPECT_TRUE(std::ranges::none_of(line, [](char c) { return c == '\n' || c == '\033'; })) << line;
  }
  EXPECT_THAT(text(view), HasSubstr("... and "));
  EXPECT_THAT(text(view), HasSubstr("warnings   1"));
}

TEST(Screen, SaysWhenTheRunIsSilentAndWhenItHasEnded) {
  View view;
  hear(view, msgs::kStatus, a_status());
  EXPECT_THAT(text(view, 1), Not(HasSubstr("SILENT")));
  EXPECT_THAT(text(view, 7), HasSubstr("SILENT for 7 s"));
  status_t end = a_status();
  end.state = "failed";
  end.exit_code = 4;
  hear(view, msgs::kStatus, end);
  EXPECT_TRUE(view.ended());
  EXPECT_THAT(text(view, 100), HasSubstr("failed, exit code 4"));
}

TEST(Screen, CountsContactsOverAllChunks) {
  View view;
  hear(view, msgs::kStatus, a_status());
  contact_sets_t part{};
  part.chunks = 2;
  part.count = 3;
  part.contacts.resize(3);
  hear(view, msgs::kContacts, part);
  part.chunk = 1;
  hear(view, msgs::kContacts, part);
  EXPECT_THAT(text(view), HasSubstr("6 contact patches"));
}

TEST(Screen, SaysThatThereIsNoRunAndThatMessagesMakeNoSense) {
  View view;
  EXPECT_THAT(text(view), HasSubstr("ballast run SCENE --lcm"));
  const char junk[16] = "not a message";
  view.take(msgs::kStatus, junk, sizeof junk);
  EXPECT_FALSE(view.has_status());
  hear(view, msgs::kStatus, a_status());
  EXPECT_THAT(text(view), HasSubstr("1 NOT DECODABLE"));
}

}  // namespace
}  // namespace ballast::monitor
