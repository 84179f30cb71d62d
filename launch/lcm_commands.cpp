// A subscriber thread that fills a list; the coordinator empties it between two looks at the rings.
#include "launch/lcm_commands.h"

#include <fmt/format.h>
#include <signal.h>

#include <atomic>
#include <ballast/command_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <mutex>
#include <thread>

#include "msgs/channels.h"
#include "msgs/url.h"

namespace ballast::launch {

namespace {

constexpr std::size_t kMost = 1000;  // commands waiting; a flood of them is a mistake or malice
constexpr int kSlice = 50;           // ms between looks at the end

Error cannot_open(const std::string& url) {
  return {"LCM cannot open '" + url + "' for commands",
          "udpm: is there a route to it? tcpq: is there a server? Logs (file:) hold no commands", "--lcm-url"};
}

}  // namespace

struct CommandListener::Worker {
  explicit Worker(const std::string& url) : lcm(url) {}

  void run() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);  // signals are the coordinator's
    // relaxed: the flag carries nothing but itself
    while (!ended.load(std::memory_order_relaxed) && lcm.handleTimeout(kSlice) >= 0) {
    }
  }
  void hear(const lcm::ReceiveBuffer*, const std::string&, const command_t* message) {
    const std::lock_guard lock(mutex);
    if (commands.size() < kMost) commands.push_back({message->action, message->steps});
  }

  lcm::LCM lcm;
  std::mutex mutex;
  std::vector<RunCommand> commands;
  std::atomic<bool> ended = false;
  std::thread thread;
};

Result<std::unique_ptr<CommandListener>> CommandListener::make(const std::string& url) {
  if (url.starts_with("file:")) return cannot_open(url);
  auto worker = std::make_unique<Worker>(url);
  if (!worker->lcm.good() || !worker->lcm.subscribe(msgs::kCommand, &Worker::hear, worker.get())) {
    return cannot_open(url);
  }
  worker->thread = std::thread([w = worker.get()] { w->run(); });
  return std::unique_ptr<CommandListener>(new CommandListener(std::move(worker)));
}

CommandListener::CommandListener(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}

CommandListener::~CommandListener() {
  worker_->ended.store(true, std::memory_order_relaxed);
  worker_->thread.join();
}

std::vector<RunCommand> CommandListener::take() {
  const std::lock_guard lock(worker_->mutex);
  return std::exchange(worker_->commands, {});
}

int tell(const RunCommand& command, const std::string& asked) {
  const auto url = msgs::url_to_open(asked);
  if (!url) {
    fmt::print(stderr, "ballast: {}\n", url.error().text());
    return kBadInput;
  }
  lcm::LCM lcm(*url);
  command_t message;
  message.action = command.action;
  message.steps = command.steps;
  if (lcm.good() && lcm.publish(msgs::kCommand, &message) == 0) return kFine;
  fmt::print(stderr, "ballast: {}\n", cannot_open(*url).text());
  return kProcessFailed;
}

}  // namespace ballast::launch
