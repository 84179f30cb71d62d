// The publishing thread: takes from the queue, makes messages, hands them to LCM. Whatever LCM does - a full socket, a
// subscriber that sleeps - happens to this thread alone.
#include "launch/publish.h"

#include <signal.h>
#include <sys/resource.h>

#include <atomic>
#include <lcm/lcm-cpp.hpp>
#include <thread>
#include <variant>

#include "launch/publish_messages.h"
#include "launch/publish_queue.h"
#include "msgs/channels.h"
#include "msgs/url.h"

namespace ballast::launch {

using exchange::Frame;
using exchange::FrameKind;
using exchange::Role;

namespace {

constexpr std::size_t kQueueBytes = 4 << 20;  // 25 frames of 5000 particles, or 800 rows of 28 bodies
constexpr std::size_t kItemBytes = 256;       // what an item costs beside its payload
constexpr auto kStatusEvery = std::chrono::milliseconds(100);
constexpr auto kFarewell = std::chrono::milliseconds(500);  // to send what is left at the end

}  // namespace

struct Publisher::Worker {
  struct FrameItem {
    Role role;
    Frame frame;
  };
  using Item = std::variant<FrameItem, RunStatus>;

  Worker(const Prepared& prepared, std::string where)
      : url(std::move(where)), lcm(std::make_unique<lcm::LCM>(url)), facts(MessageFacts::of(prepared)) {}

  void run() {
    // Ctrl-C is the coordinator's; and a tcpq server that dies while LCM writes to it would end us all with SIGPIPE.
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    // 10: on shared cores the two processes of the run come first. Linux applies it to the calling thread only.
    setpriority(PRIO_PROCESS, 0, 10);
    while (auto item = queue.take()) {
      if (const auto* frame = std::get_if<FrameItem>(&*item)) {
        send_frame(frame->role, frame->frame);
      } else {
        send_status(std::get<RunStatus>(*item));
      }
    }
    queue.mark_done();
  }

  template <class Message>
  void send(const char* channel, const Message& message) {
    (lcm->publish(channel, &message) == 0 ? sent : failed).fetch_add(1, std::memory_order_relaxed);  // counts only
  }
  template <class Message>
  void send(const char* channel, const std::vector<Message>& messages) {
    for (const Message& message : messages) send(channel, message);
  }

  void send_frame(Role role, const Frame& frame) {
    std::int64_t& number = frames[frame.head.kind];
    switch (frame.head.kind) {
      case FrameKind::kBodies:
        send(msgs::kBodies, body_messages(facts, frame, number));
        if (facts.fluid) send(msgs::kWrenches, wrench_messages(facts, frame, number));
        break;
      case FrameKind::kFluid: {
        const fluid_statistics_t message = fluid_message(frame);
        limit = message.step_limit;
        dropped_by_fluid = message.dropped;
        send(msgs::kFluid, message);
        break;
      }
      case FrameKind::kContacts:
        send(msgs::kContacts, contact_messages(facts, frame, number));
        break;
      case FrameKind::kParticles:
        send(msgs::kParticles, particle_messages(frame, number));
        break;
      case FrameKind::kWarning:
        if (warnings.insert(frame.text()).second) send(msgs::kWarning, warning_message(role, frame));
        break;
      case FrameKind::kStep:
      case FrameKind::kProbes:
      case FrameKind::kCheckpoint:
      case FrameKind::kCommand:
        break;  // take() lets neither through
    }
    ++number;
  }

  void send_status(const RunStatus& status) {
    status_t message = status_message(facts, status, limit, speed);
    using namespace std::chrono;
    message.utime = duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
    message.sent = static_cast<std::int64_t>(sent.load(std::memory_order_relaxed));
    message.dropped = static_cast<std::int64_t>(queue.dropped()) + dropped_by_fluid;
    send(msgs::kStatus, message);
  }

  const std::string url;
  std::unique_ptr<lcm::LCM> lcm;  // used by the thread alone
  const MessageFacts facts;
  PublishQueue<Item> queue{kQueueBytes};
  std::atomic<std::uint64_t> sent = 0, failed = 0;
  std::thread thread;

  // the thread's own
  std::map<FrameKind, std::int64_t> frames;
  std::set<std::string> warnings;
  std::string limit = "unknown";
  std::int64_t dropped_by_fluid = 0;
  RealTimeFactor speed;
};

Status Publisher::available() { return ok(); }

std::uint32_t Publisher::frames_wanted(const Prepared& prepared) {
  if (!prepared.fluid) return 0;
  const Scene& scene = prepared.scene;
  std::uint32_t bits = exchange::monitor_bit(FrameKind::kFluid);
  if (prepared.contacts_shown) bits |= exchange::monitor_bit(FrameKind::kContacts);
  if (scene.output.lcm_particles > 0) bits |= exchange::monitor_bit(FrameKind::kParticles);
  return bits;
}

Result<std::unique_ptr<Publisher>> Publisher::make(const Prepared& prepared, const std::string& url,
                                                   std::function<Clock::time_point()> now) {
  auto worker = std::make_shared<Worker>(prepared, url);
  if (!worker->lcm->good()) {
    return Error{
        "LCM cannot open '" + url + "'",
        "udpm: a multicast address and a network with a route to it (ip link set lo multicast on; ip route add "
        "224.0.0.0/4 dev lo); tcpq: a running server; file: a folder that exists, with ?mode=w",
        "--lcm-url"};
  }
  worker->thread = std::thread([worker] { worker->run(); });
  return std::unique_ptr<Publisher>(new Publisher(std::move(worker), std::move(now)));
}

Publisher::Publisher(std::shared_ptr<Worker> worker, std::function<Clock::time_point()> now)
    : worker_(std::move(worker)), now_(std::move(now)) {}

Publisher::~Publisher() {
  if (!closed_) (void)close({});
}

void Publisher::take(Role role, Frame&& frame) {
  for (const FrameKind silent : {FrameKind::kStep, FrameKind::kProbes, FrameKind::kCheckpoint, FrameKind::kCommand})
    if (frame.head.kind == silent) return;
  if (frame.head.kind == FrameKind::kBodies && role != Role::kRigid) return;  // as the collector: theirs alone count
  const std::size_t bytes = kItemBytes + frame.payload.size();
  worker_->queue.offer(Worker::FrameItem{role, std::move(frame)}, bytes);
}

void Publisher::status(const RunStatus& status) {
  next_status_ = now_() + kStatusEvery;
  worker_->queue.offer(status, kItemBytes);
}

nlohmann::json Publisher::close(const RunStatus& last) {
  closed_ = true;
  worker_->queue.close(last);
  if (worker_->queue.wait_done(kFarewell)) {
    worker_->thread.join();
    worker_->lcm.reset();  // a log file is whole only now
  } else {
    worker_->thread.detach();  // blocked in LCM; it holds the worker, and ends with the process
  }
  return {{"url", worker_->url},
          {"sent", worker_->sent.load(std::memory_order_relaxed)},
          {"dropped", worker_->queue.dropped()},
          {"failed", worker_->failed.load(std::memory_order_relaxed)}};
}

}  // namespace ballast::launch
