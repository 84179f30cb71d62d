// Looks at what a run needs by using it: reserves a segment, starts the programs, runs a tiny scene, sends a message.
#include "launch/doctor.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/version.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/exchange/link.h"
#include "launch/children.h"
#include "launch/publish.h"
#include "launch/spy.h"

namespace ballast::launch {

namespace {

namespace fs = std::filesystem;
using exchange::Role;
using State = Finding::State;

/// A box in a film of water and three steps of time: both processes, the exchange, the record.
constexpr const char* kScene = R"(ballast: 1
world: { dimension: 2, duration: 3 ms, spacing: 0.1 }
fluids:
  - { name: water, material: water, fill: { box: { min: [0, -0.5, 0], max: [2, 0.5, 1] } } }
models:
  - { name: tank, static: true, shape: { open_box: { inside: [2, 1, 2] } } }
  - { name: box, shape: { box: [0.5, 1, 0.5] }, density: 500, pose: [1, 0, 1] }
numerics: { relax: false }
expect:
  - { lost_particles: 0 }
)";
constexpr const char* kRebuild = "build again: touch CMakeLists.txt, then start ballast once more";

/// A folder of its own, removed at the end; empty where none can be made.
class Scratch {
 public:
  Scratch() {
    std::error_code failed;
    std::string name = (fs::temp_directory_path(failed) / "ballast_doctor_XXXXXX").string();
    if (!failed && mkdtemp(name.data()) != nullptr) path = name;
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
  std::string path;
};

/// What a program printed; the error says how it ended.
Result<std::string> output_of(const std::string& folder, const std::string& program, std::vector<std::string> arguments,
                              double patience_s = 20) {
  const std::string log = folder + "/printed";
  Children children;
  const Role any = Role::kFluid;
  if (Status s = children.start(any, {program, std::move(arguments), {}, log}); !s) return s.error();
  const bool ended = children.wait(patience_s);
  std::ifstream file(log);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  while (text.ends_with('\n')) text.pop_back();
  const std::string how = ended ? children.how_ended(any) : fmt::format("still ran after {} s", patience_s);
  if (how != "ended with exit code 0")
    return Error{fmt::format("{} {}{}", program, how, text.empty() ? "" : ": " + text), kRebuild, "", kProcessFailed};
  return text;
}

Finding versions(const std::string& folder) {
  const fs::path tree = fs::path(program_folder()).parent_path().parent_path();
  std::string commit = "commit unknown";
  if (on_path("git")) {
    const auto git = output_of(folder, "/usr/bin/env", {"git", "-C", tree.string(), "describe", "--always", "--dirty"});
    if (git) commit = "commit " + *git;
  }
  return {State::kFine, "versions",
          fmt::format("Ballast {}, {}; compiler {} {}; Eigen {}.{}.{}, Boost {}.{}.{}", BALLAST_VERSION, commit,
#ifdef __clang__
                      "clang",
#else
                      "g++",
#endif
                      __VERSION__, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
                      BOOST_VERSION / 100000, BOOST_VERSION / 100 % 1000, BOOST_VERSION % 100),
          ""};
}

Finding machine() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  const int cores = sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
  struct sysinfo info {};
  sysinfo(&info);
  const double unit = info.mem_unit * 1e-9;
  Finding f{
      State::kFine, "machine",
      fmt::format("{} cores of {} allowed, {:.1f} of {:.1f} GB of memory free", cores, get_nprocs(),
                  static_cast<double>(info.freeram + info.bufferram) * unit, static_cast<double>(info.totalram) * unit),
      ""};
  if (cores < 2) f.seen += "; the two processes will take turns";
  return f;
}

/// Reserves and maps what a run would, and looks at what others see of it.
Finding shared_memory() {
  Finding f{State::kFault, "shared memory", "",
            "mount -t tmpfs -o size=1g tmpfs /dev/shm; in a container: --shm-size=1g"};
  struct statvfs disk {};
  if (statvfs("/dev/shm", &disk) != 0) {
    f.seen = "there is no /dev/shm";
    return f;
  }
  const double room = static_cast<double>(disk.f_bavail) * static_cast<double>(disk.f_frsize);
  exchange::SegmentPlan plan;
  plan.manifest.world.dimension = 3;
  const std::string name = exchange::Segment::make_name(), file = "/dev/shm/" + name;
  {
    auto segment = exchange::Segment::create(name, plan);
    if (!segment) {
      f.seen = segment.error().what;
      f.cure = segment.error().cure + "; " + f.cure;
      return f;
    }
    struct stat info {};
    if (stat(file.c_str(), &info) != 0 || (info.st_mode & 07777) != 0600) {
      f.seen = fmt::format("{} has mode {:o}, not 600", file, info.st_mode & 07777);
      f.cure = "mount /dev/shm as tmpfs, which keeps modes";
      return f;
    }
    f.seen = fmt::format("a segment of {:.0f} MB made, mapped, mode 600, and removed; {:.0f} MB free in /dev/shm",
                         static_cast<double>(segment->bytes()) * 1e-6, room * 1e-6);
  }
  if (access(file.c_str(), F_OK) == 0) {
    f.seen = file + " cannot be removed";
    f.cure = "make /dev/shm writable for this user";
    return f;
  }
  return {State::kFine, f.what, f.seen, ""};
}

Finding program(const std::string& folder, const char* what, const std::string& name) {
  const auto text = output_of(folder, program_folder() + "/" + name, {"--about"});
  if (!text) return {State::kFault, what, text.error().what, text.error().cure};
  std::string line = *text;
  for (std::size_t at = 0; (at = line.find('\n', at)) != std::string::npos;) line.replace(at, 1, "; ");
  return {State::kFine, what, line, ""};
}

Finding tiny_run(const std::string& folder) {
  std::ofstream(folder + "/tiny.yaml") << kScene;
  const auto text = output_of(folder, program_folder() + "/ballast_coordinator",
                              {"run", folder + "/tiny.yaml", "--quiet", "--out", folder + "/out"}, 60);
  if (!text) return {State::kFault, "a run", text.error().what, "the lines above say what is missing"};
  return {State::kFine, "a run", "a box in water, two processes, three milliseconds: exit code 0", ""};
}

Finding optional(const char* what, const Result<std::string>& found) {
  if (found) return {State::kFine, what, *found, ""};
  return {State::kAbsent, what, found.error().what, found.error().cure};
}

Result<std::string> spy_text() {
  const auto files = find_spy();
  if (!files) return files.error();
  return "java, " + files->lcm + ", " + files->charts + ", ballast_types.jar";
}

Result<std::string> povray_text() {
  if (on_path("povray")) return std::string("povray");
  return Error{"--picture cannot draw: there is no program povray", "apt-get install povray", ""};
}

Result<std::string> monitor_text() {
  if (fs::exists(program_folder() + "/ballast_monitor")) return std::string("ballast watch, ballast tap");
  return Error{"this build has no ballast_monitor", "apt-get install liblcm-dev liblcm-bin, then touch CMakeLists.txt",
               ""};
}

}  // namespace

std::string finding_text(const Finding& f) {
  const char* word = f.state == State::kFine ? "ok" : f.state == State::kAbsent ? "absent" : "FAULT";
  std::string text = fmt::format("{:<7} {}: {}", word, f.what, f.seen);
  if (!f.cure.empty()) text += fmt::format("\n{:8}cure: {}", "", f.cure);
  return text;
}

int doctor_verdict(const std::vector<Finding>& findings) {
  const bool fault = std::ranges::any_of(findings, [](const Finding& f) { return f.state == State::kFault; });
  return fault ? kProcessFailed : kFine;
}

int doctor() {
  std::vector<Finding> findings;
  const auto tell = [&](Finding f) {
    fmt::print("{}\n", finding_text(f));
    std::fflush(stdout);
    findings.push_back(std::move(f));
  };
  const Scratch scratch;
  if (scratch.path.empty()) {
    tell({State::kFault, "temporary files", "no folder can be made for them",
          "let TMPDIR name a folder that may be written to"});
    return kProcessFailed;
  }
  tell(versions(scratch.path));
  tell(machine());
  tell(shared_memory());
  tell(program(scratch.path, "fluid process", "fluid_server"));
  tell(program(scratch.path, "rigid engines", "rigid_client"));
  tell(tiny_run(scratch.path));
  tell(optional("messages", lcm_round_trip()));
  tell(optional("text monitor", monitor_text()));
  tell(optional("lcm-spy", spy_text()));
  tell(optional("pictures", povray_text()));
  const int code = doctor_verdict(findings);
  fmt::print("{}\n", code == kFine ? "A run would work." : "A run would not work: cure what is marked FAULT.");
  return code;
}

}  // namespace ballast::launch
