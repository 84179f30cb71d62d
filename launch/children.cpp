// Child processes by fork and exec: posix_spawn cannot ask for the death signal.
#include "launch/children.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

namespace ballast::launch {

using exchange::Role;

namespace {

std::size_t index(Role role) { return static_cast<std::size_t>(role); }

/// In the child, between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment, pid_t parent,
                         const char* log, int report) {
  prctl(PR_SET_PDEATHSIG, SIGCONT);  // our programs end then (exchange/process.h), and a stopped one wakes up to do so
  if (getppid() != parent) _exit(127);  // the parent died before the line above
  // Ctrl-C, a closed terminal and what a service manager sends reach the whole group: the coordinator alone decides
  // what they mean. A signal to this process itself ends it, as its sender expects.
  setpgid(0, 0);
  signal(SIGPIPE, SIG_DFL);  // ignored signals stay ignored through exec
  signal(SIGTTOU, SIG_IGN);  // a background group may be stopped for writing to the terminal
  const int null = open("/dev/null", O_RDONLY);
  if (null >= 0) dup2(null, 0);
  const int out = *log != 0 ? open(log, O_WRONLY | O_CREAT | O_TRUNC, 0644) : -1;
  if (out >= 0) {
    dup2(out, 1);
    dup2(out, 2);
  }
  execve(program, arguments, environment);
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(report, &reason, sizeof reason);
  _exit(127);
}

std::vector<std::string> merged_environment(const std::vector<std::pair<std::string, std::string>>& added) {
  std::vector<std::string> out;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    bool replaced = false;
    for (const auto& [name, value] : added) replaced = replaced || text.starts_with(name + "=");
    if (!replaced) out.push_back(text);
  }
  for (const auto& [name, value] : added) out.push_back(name + "=" + value);
  return out;
}

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> out;
  for (std::string& word : words) out.push_back(word.data());
  out.push_back(nullptr);
  return out;
}

}  // namespace

std::string Command::line() const {
  std::string text;
  for (const auto& [name, value] : environment) text += name + "=" + value + " ";
  text += program;
  for (const std::string& argument : arguments) text += " " + argument;
  return text;
}

std::string program_folder() {
  std::error_code failed;
  return std::filesystem::read_symlink("/proc/self/exe", failed).parent_path().string();
}

Children::~Children() { end_all(); }

Status Children::start(Role role, const Command& command) {
  std::vector<std::string> words = {command.program};
  words.insert(words.end(), command.arguments.begin(), command.arguments.end());
  std::vector<std::string> variables = merged_environment(command.environment);
  std::vector<char*> argv = pointers(words), envp = pointers(variables);
  int report[2];
  if (pipe2(report, O_CLOEXEC) != 0) {
    return Error{fmt::format("cannot start {}: {}", command.program, std::strerror(errno)), "free some file handles",
                 "", kProcessFailed};
  }
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) become(command.program.c_str(), argv.data(), envp.data(), parent, command.log.c_str(), report[1]);
  const int fork_error = errno;
  close(report[1]);
  int reason = pid < 0 ? fork_error : 0;
  if (pid > 0) {
    ssize_t got = 0;
    while ((got = read(report[0], &reason, sizeof reason)) < 0 && errno == EINTR) {
    }
    children_[index(role)] = {pid, std::nullopt};
  }
  close(report[0]);
  if (reason == 0) return ok();
  poll();
  return Error{
      fmt::format("cannot start the {} ({}): {}", exchange::role_name(role), command.program, std::strerror(reason)),
      "build all of Ballast: the programs lie in one folder", "", kProcessFailed};
}

void Children::poll() {
  for (Child& child : children_) {
    int status = 0;
    if (child.pid > 0 && !child.status && waitpid(child.pid, &status, WNOHANG) == child.pid) child.status = status;
  }
}

bool Children::started(Role role) const { return children_[index(role)].pid > 0; }

bool Children::running(Role role) const { return started(role) && !children_[index(role)].status; }

std::string Children::how_ended(Role role) const {
  const Child& child = children_[index(role)];
  if (child.pid <= 0 || !child.status) return "";
  if (WIFSIGNALED(*child.status)) {
    return fmt::format("was killed by signal {} ({})", WTERMSIG(*child.status), strsignal(WTERMSIG(*child.status)));
  }
  return fmt::format("ended with exit code {}", WEXITSTATUS(*child.status));
}

bool Children::wait(double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  const auto any_running = [this] { return running(Role::kFluid) || running(Role::kRigid); };
  for (poll(); any_running() && Clock::now() < deadline; poll())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return !any_running();
}

void Children::end_all() {
  for (Child& child : children_) {
    if (child.pid <= 0 || child.status) continue;
    kill(child.pid, SIGKILL);
    int status = 0;
    while (waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {
    }
    child.status = status;
  }
}

}  // namespace ballast::launch
