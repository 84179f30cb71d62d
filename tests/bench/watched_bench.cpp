// What watching costs a run: the founding scene, cut short, through the real command, with nobody to hear it, with
// messages that nobody hears, with a monitor that is stopped, with a subscriber that sleeps a second over every
// message, and with a sleep bound that nothing reaches; in turns, in a network of its own. Wall and processor time, the
// median of pairs of one turn. Checked: the same state hash.
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "monitor/listen.h"
#include "tests/bench/output.h"

namespace {

namespace fs = std::filesystem;
using namespace ballast;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";

enum class Listener { kNone, kStopped, kSlow };
struct Variant {
  const char* name;
  const char* options;
  Listener listener;
};
constexpr Variant kVariants[] = {
    {"alone", "", Listener::kNone},
    {"messages that nobody hears", "--lcm", Listener::kNone},
    {"a monitor stopped (SIGSTOP)", "--lcm", Listener::kStopped},
    {"a subscriber that sleeps 1 s per message", "--lcm", Listener::kSlow},
    {"a sleep bound that is never reached", "--set world.sleep.speed=1e-9", Listener::kNone}};

/// The same program again in a network of its own: nothing leaves the machine, and no other run is heard.
bool enter_own_network(char** argv) {
  if (std::getenv("BALLAST_OWN_NETWORK") == nullptr) {
    setenv("BALLAST_OWN_NETWORK", "1", 1);
    std::vector<char*> words;
    static char unshare[] = "unshare", user[] = "--map-root-user", net[] = "--net";
    static std::string self = fs::read_symlink("/proc/self/exe").string();
    words = {unshare, user, net, self.data()};
    for (char** word = argv + 1; *word != nullptr; ++word) words.push_back(*word);
    words.push_back(nullptr);
    execvp("unshare", words.data());
    return false;
  }
  return std::system("ip link set lo up && ip link set lo multicast on && ip route add 224.0.0.0/4 dev lo") == 0;
}

pid_t start(Listener listener, const std::string& monitor) {
  if (listener == Listener::kNone) return 0;
  const pid_t pid = fork();
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (listener == Listener::kStopped) {
      if (std::freopen("/dev/null", "w", stdout) == nullptr) _exit(1);
      execl(monitor.c_str(), "ballast_monitor", "watch", "--lcm-url", kUrl, nullptr);
      _exit(127);
    }
    const Status heard = monitor::listen(
        kUrl, "BALLAST_.*", [](const std::string&, const void*, std::size_t) { sleep(1); },
        [](double) { return true; });
    _exit(heard ? 0 : 1);
  }
  usleep(500'000);  // until it has subscribed
  if (listener == Listener::kStopped) kill(pid, SIGSTOP);
  return pid;
}

/// It must have been there to the end, or the pair says nothing.
bool end(pid_t pid) {
  if (pid == 0) return true;
  int status = 0;
  const bool there = waitpid(pid, &status, WNOHANG) == 0;
  if (!there) return std::fprintf(stderr, "watched_bench: the subscriber has ended\n"), false;
  kill(pid, SIGKILL);
  waitpid(pid, &status, 0);
  return true;
}

/// s of processor time of all processes that have ended and been waited for.
double processor_time() {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

struct Run {
  double wall = 0;       // s, from the command to its end
  double processor = 0;  // s, of the run's processes; hangs less on what else the machine does
  json record;
};

Run run(const Variant& variant, const fs::path& programs, const fs::path& out) {
  const std::string command = fmt::format(
      "'{}' run '{}/scenes/stacked_blocks.yaml' --quiet --no-expect --duration 0.5s --set numerics.pressure=wcsph "
      "--out '{}' {}{} >&2",
      (programs / "ballast_coordinator").string(), BALLAST_SOURCE_DIR, out.string(), variant.options,
      std::strcmp(variant.options, "--lcm") == 0 ? fmt::format(" --lcm-url '{}'", kUrl) : "");
  const auto began = Clock::now();
  const double used = processor_time();
  const int status = std::system(command.c_str());
  Run done{std::chrono::duration<double>(Clock::now() - began).count(), processor_time() - used, {}};
  std::ifstream file(out / "record.json");
  if (status == 0) done.record = json::parse(file, nullptr, false);
  return done;
}

}  // namespace

int main(int argc, char** argv) {
  bench::Options options;
  if (!options.parse(argc, argv, 9)) return kBadInput;
  if (!enter_own_network(argv)) {
    std::fprintf(stderr, "watched_bench: no network of its own here (unshare --map-root-user --net, iproute2)\n");
    return kProcessFailed;
  }
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  const fs::path out = fs::temp_directory_path() / fmt::format("ballast_watched_bench_{}", getpid());
  constexpr std::size_t kCount = std::size(kVariants);
  std::vector<double> walls[kCount], processors[kCount], looked;
  std::vector<bool> good(kCount, true);
  std::string hash;
  std::size_t particles = 0;
  int threads = 1;
  run(kVariants[0], programs, out);  // not counted: the first one reads programs and scene from the disk
  for (int r = 0; r < options.repetitions; ++r) {
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::size_t v = r % 2 == 0 ? i : kCount - 1 - i;  // there and back: a slow drift of the machine cancels
      const pid_t listener = start(kVariants[v].listener, (programs / "ballast_monitor").string());
      const Run done = run(kVariants[v], programs, out);
      const bool heard = end(listener);
      fs::remove_all(out);
      if (!done.record.is_object() || !done.record["state_hash"].is_string()) return kProcessFailed;
      if (hash.empty()) hash = done.record["state_hash"];
      const bool sent = kVariants[v].listener == Listener::kNone || done.record["lcm"]["sent"] > 0;
      good[v] = good[v] && heard && sent && done.record["state_hash"] == hash;
      if (v == kCount - 1) looked.push_back(done.record["sleep"]["watched_s"]);
      walls[v].push_back(done.wall);
      processors[v].push_back(done.processor);
      particles = done.record["particles"]["fluid"];
      threads = done.record["threads"];
    }
  }
  std::vector<bench::Row> rows;
  for (std::size_t v = 0; v < kCount; ++v) {
    for (const auto& [seconds, unit] : {std::pair{walls, "s"}, std::pair{processors, "s of processor time"}}) {
      std::vector<double> ratios;
      for (std::size_t r = 0; r < seconds[v].size(); ++r) ratios.push_back(seconds[v][r] / seconds[0][r]);
      rows.push_back({std::string("watched: ") + kVariants[v].name, particles, threads, bench::median(seconds[v]), unit,
                      "alone, median of pairs", bench::median(ratios), good[v]});
    }
    // What other programs take only ever adds.
    const auto fastest = [&](std::size_t k) { return *std::ranges::min_element(walls[k]); };
    rows.push_back({std::string("watched: ") + kVariants[v].name, particles, threads, fastest(v), "s, fastest",
                    "alone, fastest", fastest(v) / fastest(0), good[v]});
  }
  rows.push_back({"looking for rest that is never reached", particles, threads, bench::median(looked), "s",
                  "the whole run", bench::median(looked) / bench::median(walls[kCount - 1]), true});
  return bench::finish(options, rows, "of the run");
}
