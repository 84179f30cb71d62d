// Running povray as a child process: quiet, output kept only to quote it when it fails.
#include "common/output/povray.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <vector>

namespace ballast::output {
namespace {

std::string last_lines(const std::string& file, std::size_t bytes) {
  std::ifstream in(file);
  std::string text((std::istreambuf_iterator<char>(in)), {});
  return text.size() > bytes ? text.substr(text.size() - bytes) : text;
}

/// In the child, between fork and exec: it ends with its parent, however that ends, instead of drawing for nobody. Why
/// it cannot start goes into `report`.
[[noreturn]] void become_povray(pid_t parent, const char* log, char** argv, int report) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int in = open("/dev/null", O_RDONLY), out = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (getppid() == parent && in >= 0 && out >= 0) {
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execvp("povray", argv);
  }
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(report, &reason, sizeof reason);
  _exit(127);
}

}  // namespace

Status run_povray(const std::string& pov, const std::string& png, int threads) {
  const std::string log = png + ".log", part = png + ".part.png";
  std::vector<std::string> words = {"povray", "+I" + pov, "+O" + part, "+W1280", "+H720", "-D", "+A0.2", "+FN8", "-GA"};
  if (threads > 0) words.push_back(fmt::format("+WT{}", threads));
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  int report[2] = {-1, -1}, failed = 0, status = 0;
  const pid_t parent = getpid(), pid = pipe2(report, O_CLOEXEC) == 0 ? fork() : -1;
  if (pid == 0) become_povray(parent, log.c_str(), argv.data(), report[1]);
  if (pid < 0) failed = errno;
  close(report[1]);
  if (pid > 0 && read(report[0], &failed, sizeof failed) < 0) failed = errno;  // nothing comes once it has started
  close(report[0]);
  while (pid > 0 && waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (failed != 0) {
    std::remove(log.c_str());
    return Error{fmt::format("no picture: the program povray cannot be started ({})", std::strerror(failed)),
                 "install it: apt-get install povray", ""};
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || std::rename(part.c_str(), png.c_str()) != 0) {
    Error error{"no picture: povray failed: " + last_lines(log, 600), "the scene it was given is " + pov, ""};
    std::remove(log.c_str());
    std::remove(part.c_str());
    return error;
  }
  std::remove(log.c_str());
  return ok();
}

}  // namespace ballast::output
