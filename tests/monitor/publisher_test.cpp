// The publisher with real transports: a log file that holds everything, a subscriber that never reads, one that dies.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <ballast/body_states_t.hpp>
#include <ballast/status_t.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <thread>

#include "monitor/listen.h"
#include "msgs/channels.h"
#include "tests/monitor/frames.h"

namespace ballast::monitor::testing {
namespace {

using exchange::Role;
using launch::Publisher;
using launch::RunStatus;

RunStatus finished() {
  RunStatus status;
  status.state = "finished";
  status.steps = 12;
  return status;
}

struct Log : ::testing::Test {
  std::string path = ::testing::TempDir() + "/ballast_publisher_" + std::to_string(getpid()) + ".log";
  launch::Prepared prepared = prepared_scene();
  std::map<std::string, int> heard;
  std::vector<std::byte> last_status;

  void TearDown() override { std::filesystem::remove(path); }
  void replay() {
    const Status listened = listen(
        "file://" + path + "?speed=0", ".*",
        [&](const std::string& channel, const void* data, std::size_t bytes) {
          ++heard[channel];
          if (channel != msgs::kStatus) return;
          last_status.assign(static_cast<const std::byte*>(data), static_cast<const std::byte*>(data) + bytes);
        },
        [](double seconds) { return seconds < 10; });
    ASSERT_TRUE(listened) << listened.error().text();
  }
};

TEST_F(Log, HoldsEveryFrameOnItsChannelAndTheEnd) {
  auto publisher = Publisher::make(prepared, "file://" + path + "?mode=w");
  ASSERT_TRUE(publisher) << publisher.error().text();
  Publisher& p = **publisher;
  for (int i = 0; i < 3; ++i) p.take(Role::kRigid, bodies_frame(1));
  p.take(Role::kFluid, bodies_frame(1));  // not theirs to send
  p.take(Role::kFluid, particles_frame(2000));
  p.take(Role::kFluid, contacts_frame(10));
  p.take(Role::kFluid, fluid_frame());
  for (const char* text : {"too fast", "too fast", "too slow"}) p.take(Role::kFluid, warning_frame(text));
  p.take(Role::kFluid, frame_of(FrameKind::kStep));
  const nlohmann::json counts = p.close(finished());
  replay();
  const std::map<std::string, int> wanted = {{msgs::kBodies, 3},   {msgs::kWrenches, 3}, {msgs::kParticles, 2},
                                             {msgs::kContacts, 1}, {msgs::kFluid, 1},    {msgs::kWarning, 2},
                                             {msgs::kStatus, 1}};
  EXPECT_EQ(heard, wanted);
  EXPECT_EQ(counts["sent"], 13);
  EXPECT_EQ(counts["dropped"], 0);
  EXPECT_EQ(counts["failed"], 0);
  status_t end;
  ASSERT_GE(end.decode(last_status.data(), 0, static_cast<int>(last_status.size())), 0);
  EXPECT_EQ(end.state, "finished");
  EXPECT_EQ(end.step, 12);
  EXPECT_EQ(end.sent, 12) << "all before this one";
  EXPECT_EQ(end.step_limit, "sound") << "learnt from the statistics before it";
}

TEST_F(Log, OfARunWithoutFluidHasNoWrenches) {
  prepared.fluid = false;
  auto publisher = Publisher::make(prepared, "file://" + path + "?mode=w");
  ASSERT_TRUE(publisher);
  (*publisher)->take(Role::kRigid, bodies_frame(1));
  (void)(*publisher)->close(finished());
  replay();
  EXPECT_EQ(heard, (std::map<std::string, int>{{msgs::kBodies, 1}, {msgs::kStatus, 1}}));
}

TEST_F(Log, OfAStatusIsDueTenTimesASecond) {
  std::chrono::milliseconds passed{0};
  const auto now = [&] { return Publisher::Clock::time_point(passed); };
  auto publisher = Publisher::make(prepared, "file://" + path + "?mode=w", now);
  ASSERT_TRUE(publisher);
  Publisher& p = **publisher;
  std::vector<int> sent;  // ms
  for (; passed.count() < 450; ++passed) {
    if (!p.status_due()) continue;
    p.status(finished());
    sent.push_back(static_cast<int>(passed.count()));
  }
  EXPECT_EQ(sent, (std::vector{0, 100, 200, 300, 400}));
  (void)p.close(finished());
}

TEST(Publisher, NamesTheUrlThatCannotBeOpened) {
  const auto prepared = prepared_scene();
  const auto refused = Publisher::make(prepared, "file:///no_such_folder/run.log?mode=w");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("no_such_folder"), std::string::npos);
}

TEST(Publisher, WantsFramesOnlyOfWhatThereIsAndIsAskedFor) {
  launch::Prepared run = prepared_scene();
  run.contacts_shown = true;
  EXPECT_EQ(Publisher::frames_wanted(run), 0b1110000u);  // fluid, contacts, particles: kinds 4, 5, 6
  run.contacts_shown = false;
  EXPECT_EQ(Publisher::frames_wanted(run), 0b1010000u);
  run.scene.output.lcm_particles = 0;
  EXPECT_EQ(Publisher::frames_wanted(run), 0b0010000u);
  run.fluid = false;
  EXPECT_EQ(Publisher::frames_wanted(run), 0u);
}

/// A tcpq server that greets its client, as LCM's does, and then never reads a byte.
class DeafServer {
 public:
  DeafServer() : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    url = "tcpq://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    greeter_ = std::thread([this] {
      client_ = accept(listener_, nullptr, nullptr);
      const std::uint32_t greeting[] = {htonl(0x287617fa), htonl(0x0100)};  // server, version
      EXPECT_EQ(write(client_, greeting, sizeof greeting), static_cast<ssize_t>(sizeof greeting));
    });
  }
  ~DeafServer() {
    die();
    close(listener_);
  }
  void die() {
    if (greeter_.joinable()) greeter_.join();
    if (client_ >= 0) close(client_);
    client_ = -1;
  }
  std::string url;

 private:
  int listener_, client_ = -1;
  std::thread greeter_;
};

/// Whoever waited for the server would wait for ever: that this test comes to its end is what it shows.
TEST(Publisher, LosesMessagesButNoTimeToASubscriberThatNeverReads) {
  const auto prepared = prepared_scene();
  DeafServer server;
  auto publisher = Publisher::make(prepared, server.url);
  ASSERT_TRUE(publisher) << publisher.error().text();
  Publisher& p = **publisher;
  for (int i = 0; i < 300; ++i) p.take(Role::kFluid, particles_frame(5000));  // 48 MB; sockets and queue hold some ten
  const nlohmann::json counts = p.close(finished());
  EXPECT_GT(counts["dropped"], 100);
}

TEST(Publisher, SurvivesTheDeathOfItsSubscriber) {
  const auto prepared = prepared_scene();
  DeafServer server;
  auto publisher = Publisher::make(prepared, server.url);
  ASSERT_TRUE(publisher) << publisher.error().text();
  Publisher& p = **publisher;
  p.take(Role::kFluid, particles_frame(5000));
  server.die();
  for (int i = 0; i < 20; ++i) p.take(Role::kFluid, particles_frame(5000));
  const nlohmann::json counts = p.close(finished());  // SIGPIPE would have ended the test
  EXPECT_GT(counts["failed"].get<int>() + counts["dropped"].get<int>(), 0);
}

}  // namespace
}  // namespace ballast::monitor::testing
