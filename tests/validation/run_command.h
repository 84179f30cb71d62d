// `ballast run` as a child: what it printed, which processes it started, how it ended, what it left behind.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace ballast::testing {

namespace fs = std::filesystem;

inline std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A folder of its own, removed at the end.
class Scratch {
 public:
  Scratch() { fs::create_directories(path); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { fs::remove_all(path); }
  const fs::path path = fs::temp_directory_path() / ("ballast_validation_" + std::to_string(getpid()));
};

class Command {
 public:
  /// Starts `ballast run` with these arguments and output in folder/out, which is made anew.
  Command(const fs::path& folder, std::vector<std::string> arguments) : folder_(folder) {
    fs::remove_all(folder_ / "out");
    const std::string program = std::string(BALLAST_BIN_DIR) + "/ballast_coordinator", log = (folder_ / "log").string();
    arguments.insert(arguments.begin(), {program, "run"});
    arguments.insert(arguments.end(), {"--out", (folder_ / "out").string()});
    std::vector<char*> argv;
    for (std::string& word : arguments) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::fflush(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (!std::freopen(log.c_str(), "w", stdout) || dup2(STDOUT_FILENO, STDERR_FILENO) < 0) _exit(126);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  ~Command() {
    if (!ended_) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
  }

  /// Waits for the end while watching the children; exit code, or -signal.
  int wait() {
    for (int status = 0; !ended_;) {
      for (const auto& [name, pid] : children()) seen_.insert(name);
      if (waitpid(pid_, &status, WNOHANG) == pid_) {
        ended_ = true;
        code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
    return code_;
  }
  /// Processes that run now below the command: name and id.
  std::map<std::string, pid_t> children() const {
    std::map<std::string, pid_t> out;
    const std::string own = std::to_string(pid_);
    std::ifstream list("/proc/" + own + "/task/" + own + "/children");
    for (pid_t child = 0; list >> child;) {
      std::string name;
      std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm"), name);
      if (name == "fluid_server" || name == "rigid_client") out[name] = child;
    }
    return out;
  }
  /// Names of all that wait() has seen.
  const std::set<std::string>& seen() const { return seen_; }
  pid_t pid() const { return pid_; }
  void send(int signal) const { kill(pid_, signal); }
  /// Waits, at most 20 s, until this many children run.
  bool has_children(std::size_t count) const {
    for (int i = 0; i < 4000 && children().size() < count; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return children().size() >= count;
  }
  /// Processes on this machine, zombies aside, that have attached to this run's memory or are about to.
  std::vector<pid_t> attached() const {
    std::vector<pid_t> out;
    const std::string path = "/proc/" + std::to_string(pid_) + "/fd/";
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator("/proc", gone)) {
      std::string words(4096, 0);  // empty for a zombie; not by a stream, which throws when the process goes meanwhile
      const int file = open((entry.path() / "cmdline").c_str(), O_RDONLY | O_CLOEXEC);
      const ssize_t got = file < 0 ? 0 : read(file, words.data(), words.size());
      if (file >= 0) close(file);
      words.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
      if (words.find("--attach") != std::string::npos && words.find(path) != std::string::npos)
        out.push_back(std::atoi(entry.path().filename().c_str()));
    }
    return out;
  }
  std::string text() const { return text_of(folder_ / "log"); }
  nlohmann::json record() const { return nlohmann::json::parse(text_of(folder_ / "out/record.json"), nullptr, false); }
  /// Last row of a CSV file in the output folder, by column.
  std::map<std::string, double> last_row(const std::string& file) const {
    std::ifstream rows(folder_ / "out" / file);
    std::string head, line, last;
    std::getline(rows, head);
    while (std::getline(rows, line)) last = line;
    std::map<std::string, double> out;
    std::istringstream names(head), values(last);
    for (std::string name, value; std::getline(names, name, ',') && std::getline(values, value, ',');)
      out[name] = std::stod(value);
    return out;
  }
  /// Shared memory of this run that still exists.
  std::vector<std::string> left_behind() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator("/dev/shm")) {
      const std::string name = entry.path().filename().string();
      if (name.find("-" + std::to_string(pid_) + "-") != std::string::npos) out.push_back(name);
    }
    return out;
  }

 private:
  fs::path folder_;
  pid_t pid_ = 0;
  bool ended_ = false;
  int code_ = 0;
  std::set<std::string> seen_;
};

/// A command of a record, to be carried out after a step.
inline nlohmann::json at(int step, nlohmann::json command) {
  command["step"] = step;
  return command;
}

inline std::string scene(const std::string& name) { return BALLAST_SOURCE_DIR "/scenes/" + name + ".yaml"; }

}  // namespace ballast::testing
