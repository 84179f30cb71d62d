// One run from beginning to end: prepare, share, start, drive, judge, record.
#include "launch/run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

#include "common/output/columns.h"
#include "common/output/picture.h"
#include "common/output/vtk.h"
#include "common/output/whole_file.h"
#include "launch/children.h"
#include "launch/collect.h"
#include "launch/drive.h"
#include "launch/expect.h"
#include "launch/prepare.h"
#include "launch/publish.h"
#include "launch/record.h"
#include "launch/savings.h"
#include "launch/say.h"
#include "msgs/url.h"

namespace ballast::launch {

namespace fs = std::filesystem;
using exchange::Role;
using exchange::Segment;

namespace {

/// The outputs' folder, held by this run alone while it lives.
class OutDir {
 public:
  /// Makes the folder and removes what an earlier run left there under the names that this run writes. A run that goes
  /// on keeps the checkpoints up to its own, and the ParaView files.
  static Result<OutDir> make(const std::string& wanted, const std::string& scene, const Checkpoint* resumed);
  OutDir(OutDir&& other) noexcept : path(std::move(other.path)), file_(std::exchange(other.file_, -1)) {}
  OutDir& operator=(OutDir&&) = delete;
  ~OutDir() {
    if (file_ >= 0) close(file_);
  }
  std::string path;

 private:
  OutDir(std::string p, int file) : path(std::move(p)), file_(file) {}
  int file_;  // the folder itself, locked
};

/// Those after the one that a run goes on from, or all.
void remove_checkpoints(const fs::path& dir, const Checkpoint* resumed) {
  std::error_code failed;
  const fs::path keep = resumed ? fs::path(resumed->folder).filename() : fs::path();
  std::vector<fs::path> gone;
  for (fs::directory_iterator it(dir / checkpoint::kFolder, failed), end; !failed && it != end; it.increment(failed))
    if (it->path().filename() > keep) gone.push_back(it->path());
  for (const fs::path& folder : gone) fs::remove_all(folder, failed);
  if (resumed) return;
  if (!gone.empty()) fmt::print("removed the checkpoints of an earlier run in {}\n", dir.string());
  fs::remove(dir / checkpoint::kFolder, failed);
}

Result<OutDir> OutDir::make(const std::string& wanted, const std::string& scene, const Checkpoint* resumed) {
  std::error_code failed;
  const fs::path dir = fs::absolute(wanted.empty() ? fs::path("out") / scene : fs::path(wanted)).lexically_normal();
  fs::create_directories(dir, failed);
  if (failed)
    return Error{"cannot make folder " + dir.string() + ": " + failed.message(), "choose another one with --out", ""};
  OutDir out(dir.string(), open(dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (out.file_ < 0)
    return Error{"cannot open folder " + dir.string() + ": " + std::strerror(errno), "choose another one with --out",
                 ""};
  if (flock(out.file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    return Error{"another run writes to " + dir.string() + " right now", "wait for it or choose another with --out",
                 ""};
  for (const char* name : {"record.json", "bodies.csv", "probes.csv", "picture.png", "picture.pov"}) {
    fs::remove(dir / name, failed);
    fs::remove(dir / (std::string(name) + ".part"), failed);
  }
  const bool goes_on = resumed && fs::path(resumed->out) == dir;
  remove_checkpoints(dir, goes_on ? resumed : nullptr);
  for (fs::directory_iterator it(dir / "vtk", failed), end; !goes_on && !failed && it != end; it.increment(failed)) {
    const std::string name = it->path().filename().string();
    if (name.ends_with(".vtp") || name.ends_with(".pvd")) fs::remove(it->path(), failed);
  }
  return out;
}

std::vector<std::string> reference_folders(const std::vector<std::string>& asked) {
  if (!asked.empty()) return asked;
  // The programs lie in build/bin of the source tree.
  const fs::path tree = fs::path(program_folder()).parent_path().parent_path();
  return {"tests/validation/reference", "../shared/reference", (tree / "tests/validation/reference").string(),
          (tree.parent_path() / "shared/reference").string()};
}

std::string log_of(Role role, const std::string& out_dir) {
  return out_dir + (role == Role::kFluid ? "/fluid_server.log" : "/rigid_client.log");
}

/// Shows what a process printed, unless the coordinator says it anyway, and removes the file.
void show_log(Role role, const std::string& out_dir, const std::string& message) {
  std::ifstream file(log_of(role, out_dir));
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    const bool repeated = message.find(colon == std::string::npos ? line : line.substr(colon + 2)) != std::string::npos;
    if (!line.empty() && !repeated) say(stderr, "{}\n", line);
  }
  fs::remove(log_of(role, out_dir));
}

Command command_for(Role role, const std::string& segment, const Prepared& prepared, int threads) {
  const std::string folder = program_folder();
  if (role == Role::kRigid)
    return {folder + "/rigid_client", {"--attach", segment, "--engine", prepared.scene.coupling.engine}, {}, {}};
  Command command{folder + "/fluid_server", {"--attach", segment}, {}, {}};
  if (threads > 0) command.environment.emplace_back("OMP_NUM_THREADS", std::to_string(threads));
  return command;
}

Status start_or_print(Children& children, const Prepared& prepared, const std::string& segment,
                      const RunOptions& options, const std::string& out_dir) {
  if (options.by_hand)
    say(stdout, "Type each of these in a terminal of its own; the run starts when they are there.\n");
  for (Role role : {Role::kFluid, Role::kRigid}) {
    if (!(role == Role::kFluid ? prepared.fluid : prepared.rigid)) continue;
    Command command = command_for(role, segment, prepared, options.threads);
    command.log = log_of(role, out_dir);
    if (options.by_hand) {
      say(stdout, "  {}\n", command.line());
    } else if (Status s = children.start(role, command); !s) {
      return s;
    }
  }
  std::fflush(stdout);
  return ok();
}

/// What watches and steers a run; all empty where nobody asked.
struct Lcm {
  std::string url;
  Replay replay;
  std::unique_ptr<Publisher> publisher;
  std::unique_ptr<CommandListener> commands;
};

/// Finds what is wrong with the wishes before anything starts.
Result<Lcm> plan_lcm(const RunOptions& options, const Prepared& prepared) {
  Lcm lcm;
  if (!options.replay.empty()) {
    auto replay = read_replay(options.replay);
    if (!replay) return replay.error();
    if (Status s = same_motion(*replay, prepared.scene); !s) return s.error();
    lcm.replay = *std::move(replay);
  }
  if (!prepared.scene.output.lcm) return lcm;
  if (Status s = Publisher::available(); !s) return s.error();
  auto url = msgs::url_to_open(options.lcm_url);
  if (!url) return url.error();
  lcm.url = *url;
  return lcm;
}

/// After the children have started: they would inherit its sockets.
Status open_lcm(Lcm& lcm, const RunOptions& options, const Prepared& prepared) {
  if (lcm.url.empty()) return ok();
  auto publisher = Publisher::make(prepared, lcm.url);
  if (!publisher) return publisher.error();
  lcm.publisher = std::move(*publisher);
  if (!options.lcm_commands) return ok();
  auto commands = CommandListener::make(lcm.url);
  if (!commands) return commands.error();
  lcm.commands = std::move(*commands);
  return ok();
}

/// Poses of all bodies at a row of the rows of bodies.
std::vector<Pose> poses_at(const Prepared& prepared, const Table& rows, std::size_t row) {
  std::vector<Pose> out;
  for (const Body& body : prepared.bodies) out.push_back(body.pose);
  const std::vector<int> moving = output::moving_models(prepared.scene);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const std::size_t c = i * output::kBodyValues;
    out[static_cast<std::size_t>(moving[i])] = {
        {rows.at(row, c), rows.at(row, c + 1), rows.at(row, c + 2)},
        {rows.at(row, c + 3), rows.at(row, c + 4), rows.at(row, c + 5), rows.at(row, c + 6)}};
  }
  return out;
}

/// Picture and ParaView files of a run without fluid; the fluid process makes them in all others.
void draw_dry(const Prepared& prepared, const Table& rows, const std::string& out_dir, int threads) {
  if (rows.rows() == 0) return;
  const auto warn = [](const Status& s) {
    if (!s) say(stderr, "ballast: warning: {}\n", s.error().text());
  };
  if (prepared.scene.output.vtk) {
    output::VtkSeries series(out_dir + "/vtk");
    for (std::size_t row = 0; row < rows.rows(); ++row) {
      warn(series.add(rows.times[row], {}, prepared.bodies, poses_at(prepared, rows, row)));
    }
  }
  if (prepared.scene.output.picture) {
    warn(output::make_picture(out_dir, prepared.scene, prepared.bodies, poses_at(prepared, rows, rows.rows() - 1), {},
                              threads));
  }
}

/// A scene with a hundred copies of one fault has one fault: the record has every line.
void print_warnings(const nlohmann::json& warnings) {
  constexpr std::size_t kShown = 12;
  for (std::size_t i = 0; i < std::min(warnings.size(), kShown); ++i)
    say(stderr, "ballast: warning: {}\n", warnings[i].get<std::string>());
  if (warnings.size() > kShown) say(stderr, "ballast: {} more warnings in record.json\n", warnings.size() - kShown);
}

/// The checkpoint to go on from, where one was asked for; says which newer ones were refused.
Result<std::optional<Checkpoint>> find_checkpoint(const RunOptions& options) {
  if (options.resume.empty()) return std::optional<Checkpoint>();
  auto found = newest_checkpoint(options.resume);
  if (!found) return found.error();
  for (const std::string& reason : found->refused) fmt::print(stderr, "ballast: warning: refused {}\n", reason);
  fmt::print("resuming {} after step {}, t = {:.6g} s\n", found->scene_name, found->step, found->time);
  std::fflush(stdout);
  return std::optional(std::move(*found));
}

Result<Prepared> prepare_run(const RunOptions& options, const std::optional<Checkpoint>& resumed) {
  if (!resumed) return prepare(options.scene, options.overrides);
  const std::string name = resumed->scene_name + ".yaml";
  auto scene = options.scene.empty() ? read_scene_text(resumed->scene_text, name, options.overrides)
                                     : read_scene(options.scene, options.overrides);
  if (!scene) return scene.error();
  auto prepared = prepare(*std::move(scene), name);
  if (!prepared) return prepared;
  // Only now: the checkpoint has what `auto` became.
  if (auto same = same_scene(*resumed, prepared->scene); !same) return same.error();
  const std::string& out = options.out;
  if (prepared->scene.output.vtk && !out.empty() && fs::absolute(out).lexically_normal() != fs::path(resumed->out))
    return Error{"a run with ParaView files can only go on in its own folder", "leave --out away", "--out"};
  return prepared;
}

/// Half a run neither meets nor misses what is expected of a whole one.
std::string why_not_judged(const Outcome& outcome) {
  if (outcome.interrupted) return "the run was stopped by " + outcome.stopped_by;
  if (outcome.exit == kDiverged) return "the run diverged";
  return outcome.exit == kBadInput ? "the run could not start" : "the run failed";
}

/// Judges, writes the record, prints the end of the run.
int conclude(const Prepared& prepared, Outcome& outcome, Collector& collector, const RunOptions& options,
             const std::string& out_dir) {
  if (Status s = collector.close(); !s && outcome.exit == kFine) {
    outcome.exit = kProcessFailed;
    outcome.message = s.error().text();
  }
  const Evidence evidence{prepared.scene,
                          prepared.bodies,
                          collector.bodies(),
                          collector.probes(),
                          outcome.fluid,
                          outcome.rigid,
                          momentum_imbalance(outcome.fluid, outcome.rigid),
                          reference_folders(options.references)};
  std::vector<Verdict> verdicts = judge(evidence);
  const bool whole = outcome.exit == kFine;
  if (!options.no_expect)
    if (auto loss = judge_unforeseen_loss(evidence)) verdicts.push_back(*std::move(loss));
  for (Verdict& v : verdicts) {
    if (!whole) {
      v.not_judged = why_not_judged(outcome);
    } else if (v.reference_missing) {
      say(stdout, "not judged: {}: reference not installed (--references DIR)\n", v.name);
    } else if (!v.pass) {
      say(stdout, "MISSED: {}: {:.6g}, bound {}{}\n", v.name, v.value, v.bound_text(),
          v.note.empty() ? "" : " (" + v.note + ")");
      if (outcome.exit == kFine) outcome.exit = kExpectationMissed;
    }
  }
  if (!prepared.fluid) draw_dry(prepared, collector.bodies(), out_dir, options.threads);
  nlohmann::json record = make_record(prepared, outcome, collector, verdicts, options.threads);
  std::string go_on;  // from where a run that broke off can
  if (!whole)
    if (auto last = newest_checkpoint(out_dir)) {
      record["last_checkpoint"] = {{"step", last->step}, {"time_s", last->time}, {"folder", last->folder}};
      go_on = fmt::format("last whole checkpoint: step {}, t = {:.6g} s; go on from it: ballast run --resume {}",
                          last->step, last->time, fs::path(out_dir).lexically_proximate(fs::current_path()).string());
    }
  if (!options.quiet) {
    for (const std::string& line : fill_lines(outcome.fluid)) say(stdout, "{}\n", line);
  }
  print_warnings(record["warnings"]);
  if (Status s = output::write_whole(out_dir + "/record.json", record.dump(2) + "\n"); !s) {
    collector.unfinish();
    if (!outcome.message.empty()) say(stderr, "ballast: {}\n", outcome.message);
    for (Role role : {Role::kFluid, Role::kRigid}) show_log(role, out_dir, outcome.message);
    return fail(s.error());
  }
  std::string files = "record.json";
  for (const char* name : {"bodies.csv", "probes.csv", "picture.png", "vtk"}) {
    if (fs::exists(fs::path(out_dir) / name)) files += std::string(", ") + name;
  }
  fs::path shown = fs::path(out_dir).lexically_proximate(fs::current_path());
  if (!outcome.message.empty()) say(stderr, "ballast: {}\n", outcome.message);
  for (Role role : {Role::kFluid, Role::kRigid}) show_log(role, out_dir, outcome.message);
  std::fflush(stderr);
  for (const std::string& line : summary_lines(record, fmt::format("{} ({})", shown.string(), files)))
    say(stdout, "{}\n", line);
  if (!go_on.empty()) say(stdout, "{}\n", go_on);
  if (options.left_out)
    for (const std::string& line : savings_lines(record)) say(stdout, "{}\n", line);
  return outcome.exit;
}

}  // namespace

int run(const RunOptions& options) {
  auto resumed = find_checkpoint(options);
  if (!resumed) return fail(resumed.error());
  const Checkpoint* from = *resumed ? &**resumed : nullptr;
  auto prepared = prepare_run(options, *resumed);
  if (!prepared) return fail(prepared.error());
  if (options.by_hand) expect_foreign_engine(*prepared);
  auto lcm = plan_lcm(options, *prepared);
  if (!lcm) return fail(lcm.error());
  const std::string wanted = options.out.empty() && from ? from->out : options.out;
  auto folder = OutDir::make(wanted, prepared->scene.name, from);
  if (!folder) return fail(folder.error());
  const std::string& out_dir = folder->path;
  for (const std::string& name : Segment::remove_stale()) {
    say(stderr, "ballast: removed /dev/shm/{}, left by a run that was killed\n", name);
  }
  if (!options.quiet) {
    for (const LeftOut& l : prepared->left_out) {
      if (l.what.ends_with("process")) say(stdout, "{}: no {}\n", l.why, l.what);
    }
    std::fflush(stdout);
  }
  auto collector = Collector::make(prepared->scene, prepared->fluid, prepared->rigid, out_dir);
  if (!collector) return fail(collector.error());
  if (from)
    if (Status s = collector->go_on(from->collected); !s) return fail(s.error());

  exchange::SegmentPlan plan;
  plan.manifest = make_manifest(prepared->scene, prepared->bodies);
  // What the processes see; checkpoints and record keep the scene as it is, whoever reads along this time.
  Scene sent = prepared->scene;
  sent.coupling.contact_sets = prepared->contact_sets ? When::kAlways : When::kNever;
  plan.scene_text = print_scene(sent);
  if (!prepared->contact_sets) plan.contact_bytes = 1;  // the least there is
  plan.out_dir = out_dir;
  plan.threads = static_cast<std::uint32_t>(options.threads);
  plan.fluid = prepared->fluid;
  plan.rigid = prepared->rigid;
  plan.named = options.by_hand;
  plan.peer_timeout = options.timeout;
  plan.checkpoint_every = prepared->scene.output.checkpoint_every;
  plan.commands = options.lcm_commands || !lcm->replay.commands.empty();
  if (from) plan.first_step = from->step, plan.resume_dir = from->folder;
  if (!lcm->url.empty()) plan.monitor = Publisher::frames_wanted(*prepared);
  const std::string name = Segment::make_name();
  auto segment = Segment::create(name, plan);
  if (!segment) return fail(segment.error());

  Children children;
  if (Status s = start_or_print(children, *prepared, segment->path(), options, out_dir); !s) return fail(s.error());
  if (Status s = open_lcm(*lcm, options, *prepared); !s) return fail(s.error());
  CheckpointWriter checkpoints(*prepared, out_dir);
  Outcome outcome =
      drive(*segment, children, *prepared, *collector,
            {options.by_hand, options.quiet, lcm->commands.get(), lcm->replay.stop_after, lcm->publisher.get(),
             options.timeout, plan.checkpoint_every > 0 ? &checkpoints : nullptr, lcm->replay.commands, from});
  return conclude(*prepared, outcome, *collector, options, out_dir);
}

}  // namespace ballast::launch
