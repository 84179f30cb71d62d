// Debian's lcm-spy script cannot start: it gives Java an option that Java 9 removed. So its class is started here, with
// the jars that it needs and the types in the environment's CLASSPATH, where it looks for them.
#include "launch/spy.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "common/result.h"
#include "launch/children.h"
#include "launch/say.h"
#include "msgs/url.h"

namespace ballast::launch {

namespace {

namespace fs = std::filesystem;

std::string find_jar(const std::string& name) {
  for (const char* folder : {"/usr/share/java/", "/usr/local/share/java/"}) {
    if (fs::exists(folder + name)) return folder + name;
  }
  return "";
}

int become(std::vector<std::string> words) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::fflush(nullptr);
  execvp(argv[0], argv.data());
  return fail(
      {fmt::format("cannot start {}: {}", words[0], std::strerror(errno)), "build all of Ballast", "", kProcessFailed});
}

}  // namespace

bool on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string folders = path ? path : "";
  for (std::size_t at = 0; at <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', at), folders.size());
    if (access((folders.substr(at, end - at) + "/" + program).c_str(), X_OK) == 0) return true;
    at = end + 1;
  }
  return false;
}

Result<SpyFiles> find_spy() {
  SpyFiles files{program_folder() + "/ballast_types.jar", find_jar("lcm.jar"), find_jar("jchart2d.jar")};
  if (!on_path("java"))
    return Error{"lcm-spy needs Java, and there is no program java", "apt-get install default-jre", ""};
  if (files.lcm.empty()) return Error{"lcm-spy is not installed: no lcm.jar", "apt-get install liblcm-java", ""};
  if (files.charts.empty())
    return Error{"lcm-spy cannot show fields: no jchart2d.jar", "apt-get install libjchart2d-java", ""};
  if (!fs::exists(files.types))
    return Error{
        "the types for lcm-spy were not built: no " + files.types,
        "apt-get install default-jdk liblcm-dev liblcm-bin liblcm-java, then `touch CMakeLists.txt` and start again",
        ""};
  return files;
}

int spy(const std::string& lcm_url) {
  const auto url = msgs::url_to_open(lcm_url);
  if (!url) return fail(url.error());
  const auto files = find_spy();
  if (!files) return fail(files.error());
  if (const char* display = std::getenv("DISPLAY"); display == nullptr || *display == 0)
    return fail({"lcm-spy is a window, and there is no DISPLAY", "use ballast watch instead", ""});
  setenv("CLASSPATH", files->types.c_str(), 1);
  setenv("LCM_DEFAULT_URL", url->c_str(), 1);
  return become(
      {"java", "-Djava.net.preferIPv4Stack=true", "-Xmx256m", "-cp", files->lcm + ":" + files->charts, "lcm.spy.Spy"});
}

int become_monitor(std::vector<std::string> arguments) {
  const std::string program = program_folder() + "/ballast_monitor";
  if (!fs::exists(program)) {
    return fail({"this build of Ballast has no monitors, for LCM was missing: no " + program,
                 "apt-get install liblcm-dev liblcm-bin, then `touch CMakeLists.txt` and start again", ""});
  }
  arguments.insert(arguments.begin(), program);
  return become(std::move(arguments));
}

}  // namespace ballast::launch
