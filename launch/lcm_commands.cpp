// A subscriber thread that fills a list; the coordinator empties it between two looks at the rings.
#include "launch/lcm_commands.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <ballast/command_t.hpp>
#include <ballast/status_t.hpp>
#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <mutex>
#include <thread>

#include "launch/command_message.h"
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
  void hear(const lcm::ReceiveBuffer* buffer, const std::string&) {
    const auto command = read_command(buffer->data, buffer->data_size);
    const std::lock_guard lock(mutex);
    if (!command)
      ++unreadable;
    else if (command->run != 0 && command->run != getpid())
      return;  // another run is meant
    else if (commands.size() < kMost)
      commands.push_back(*command);
  }

  lcm::LCM lcm;
  std::mutex mutex;
  std::vector<RunCommand> commands;
  std::uint64_t unreadable = 0;
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
  // One entry for all of them: a flood of junk must not fill the record.
  if (worker_->unreadable > 0) {
    worker_->unreadable = 0;
    worker_->commands.push_back({"(unreadable message)", 0});
  }
  return std::exchange(worker_->commands, {});
}

namespace {

/// Who is heard.
struct Runs {
  std::map<std::int64_t, std::string> obeying;  // scenes of the runs
  std::string deaf;                             // scene of a run that obeys no commands
  void hear(const lcm::ReceiveBuffer*, const std::string&, const status_t* status) {
    if (status->state == "finished" || status->state == "failed")
      obeying.erase(status->run);
    else if (status->obeys)
      obeying[status->run] = status->scene;
    else
      deaf = status->scene;
  }
  std::string list() const {
    std::string text;
    for (const auto& [run, scene] : obeying) text += fmt::format("{}{} ('{}')", text.empty() ? "" : ", ", run, scene);
    return text;
  }
};

}  // namespace

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
  message.body = command.body;
  message.duration = command.duration;
  std::ranges::copy(command.force, message.force);
  std::ranges::copy(command.torque, message.torque);
  std::ranges::copy(command.position, message.position);
  std::ranges::copy(command.orientation, message.orientation);
  std::ranges::copy(command.gravity, message.gravity);
  Runs runs;
  if (!lcm.good() || !lcm.subscribe(msgs::kStatus, &Runs::hear, &runs)) {
    fmt::print(stderr, "ballast: {}\n", cannot_open(*url).text());
    return kProcessFailed;
  }
  // A run says ten times a second who it is: one is waited for, and then the time in which any other would be heard.
  using Clock = std::chrono::steady_clock;
  auto end = Clock::now() + std::chrono::seconds(2);
  for (bool heard = false; Clock::now() < end && lcm.handleTimeout(kSlice) >= 0;) {
    if (heard || runs.obeying.empty()) continue;
    heard = true;
    end = std::min(end, Clock::now() + std::chrono::milliseconds(150));
  }
  if (command.run != 0 && !runs.obeying.empty() && !runs.obeying.contains(command.run)) {
    fmt::print(stderr, "ballast: --run {}: no such run obeys commands here\n  it may be: {}\n", command.run,
               runs.list());
    return kBadInput;
  }
  if (command.run == 0 && runs.obeying.size() > 1) {
    fmt::print(stderr, "ballast: {} runs obey commands here: {}\n  say which: tell --run {} ...\n", runs.obeying.size(),
               runs.list(), runs.obeying.begin()->first);
    return kBadInput;
  }
  if (!runs.obeying.empty()) {
    message.run = command.run != 0 ? command.run : runs.obeying.begin()->first;
    if (lcm.publish(msgs::kCommand, &message) == 0) return kFine;
    fmt::print(stderr, "ballast: {}\n", cannot_open(*url).text());
    return kProcessFailed;
  }
  if (runs.deaf.empty())
    fmt::print(stderr, "ballast: no run is heard at '{}'\n  start one with --lcm-commands, or give its --lcm-url\n",
               *url);
  else
    fmt::print(stderr, "ballast: the run of '{}' obeys no commands\n  start it with --lcm-commands\n", runs.deaf);
  return kProcessFailed;
}

}  // namespace ballast::launch
