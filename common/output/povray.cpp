// Running povray as a child process: quiet, output kept only to quote it when it fails.
#include "common/output/povray.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
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

}  // namespace

Status run_povray(const std::string& pov, const std::string& png, int threads) {
  const std::string log = png + ".log", part = png + ".part.png";
  std::vector<std::string> words = {"povray", "+I" + pov, "+O" + part, "+W1280", "+H720", "-D", "+A0.2", "+FN8", "-GA"};
  if (threads > 0) words.push_back(fmt::format("+WT{}", threads));
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t pid = 0;
  const int failed = posix_spawnp(&pid, "povray", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    std::remove(log.c_str());
    return Error{fmt::format("no picture: the program povray cannot be started ({})", std::strerror(failed)),
                 "install it: apt-get install povray", ""};
  }
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
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
