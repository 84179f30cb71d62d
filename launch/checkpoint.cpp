// The coordinator's part of checkpoints: written last, read first.
#include "launch/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/checkpoint/state.h"

namespace ballast::launch {

namespace fs = std::filesystem;
using exchange::Role;
using nlohmann::json;

namespace {

constexpr const char* kPartNames[] = {checkpoint::kFluidPart, checkpoint::kRigidPart};

/// Folders of checkpoints, newest first.
std::vector<fs::path> folders(const std::string& out_dir) {
  std::vector<fs::path> found;
  std::error_code failed;
  for (fs::directory_iterator it(fs::path(out_dir) / checkpoint::kFolder, failed), end; !failed && it != end;
       it.increment(failed)) {
    const std::string name = it->path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos) found.push_back(it->path());
  }
  std::ranges::sort(found, std::greater<>());
  return found;
}

/// What the coordinator's part holds.
struct RunPart {
  std::uint64_t step = 0;
  double time = 0;
  std::string scene_name, scene_text;
  json parts, commands;
  Collector::Snapshot collected;
  template <class A>
  void state(A& a) {
    a("step", step), a("time", time), a("scene_name", scene_name), a("scene", scene_text);
    a("parts", parts), a("commands", commands), a("collected", collected);
  }
};

Result<Checkpoint> read_checkpoint(const std::string& folder, const std::string& out_dir) {
  auto content = checkpoint::read_part(folder, checkpoint::kRunPart);
  if (!content) return content.error();
  RunPart run;
  if (auto restored = checkpoint::restore(*content, run); !restored) return restored.error();
  for (const auto& [name, seal] : run.parts.items()) {
    checkpoint::Seal seen;
    if (auto part = checkpoint::read_part(folder, name, &seen); !part) return part.error();
    if (seen != checkpoint::Seal{seal.at("bytes"), seal.at("hash")})
      return Error{fmt::format("{}/{}: this part belongs to another checkpoint", folder, name),
                   "resume from an earlier checkpoint, or start the run anew", ""};
  }
  Checkpoint out;
  out.folder = folder, out.out = out_dir, out.step = run.step, out.time = run.time;
  out.scene_name = run.scene_name, out.scene_text = run.scene_text;
  out.collected = std::move(run.collected), out.commands = std::move(run.commands);
  return out;
}

/// A key that a resumed run may change, as a path of the printed scene.
bool harmless(const std::string& path) {
  for (const char* key : {"/description", "/output/checkpoint", "/output/picture", "/output/camera", "/output/lcm",
                          "/output/lcm_particles", "/expect"})
    if (path == key || path.starts_with(std::string(key) + "/")) return true;
  return false;
}

/// Does the duration decide nothing but the end? Where nothing has weight, ODE's limits on how fast bodies that overlap
/// part hang on it.
bool duration_is_free(const Scene& scene) {
  const bool free = std::ranges::any_of(scene.models, [](const Model& m) { return m.motion == Motion::kDynamic; });
  return !free || scene.coupling.engine == "free_body" || scene.world.gravity.norm() > 0;
}

}  // namespace

Result<Checkpoint> newest_checkpoint(const std::string& out_dir) {
  const std::string dir = fs::absolute(out_dir).lexically_normal().string();
  std::vector<std::string> refused;
  for (const fs::path& folder : folders(dir)) {
    auto read = read_checkpoint(folder.string(), dir);
    if (read) {
      read->refused = std::move(refused);
      return read;
    }
    refused.push_back(read.error().what);
  }
  std::string what = fmt::format("no checkpoint to resume from in {}", dir);
  for (const std::string& reason : refused) what += "\n  " + reason;
  return Error{what, "give the output folder of a run with output.checkpoint.every (--checkpoint TIME)", "--resume"};
}

Status same_scene(const Checkpoint& checkpoint, const Scene& scene) {
  auto before = read_scene_text(checkpoint.scene_text, checkpoint.scene_name + ".yaml");
  if (!before) return before.error();
  std::string keys;
  const bool longer = duration_is_free(scene);
  for (const std::string& path : scene_differences(*before, scene))
    if (!harmless(path) && !(longer && path == "/world/duration")) keys += (keys.empty() ? "" : ", ") + path.substr(1);
  if (keys.empty() && !(scene.world.duration > checkpoint.time))
    return Error{fmt::format("the checkpoint {} is of t = {:.6g} s, and world.duration is {:.6g} s", checkpoint.folder,
                             checkpoint.time, scene.world.duration),
                 "let the run last longer (--duration)", "--resume"};
  if (keys.empty()) return ok();
  if (keys == "world/duration")
    return Error{fmt::format("the run of the checkpoint {} was to last {:.6g} s, not {:.6g} s", checkpoint.folder,
                             before->world.duration, scene.world.duration),
                 "leave --duration away: without gravity the engine parts bodies that overlap at a speed that hangs on "
                 "the duration, so a longer run would not be the same from the start",
                 "--resume"};
  return Error{fmt::format("the scene is not that of the checkpoint {}: {} {}", checkpoint.folder, keys,
                           keys.find(',') == std::string::npos ? "differs" : "differ"),
               "give the scene and the options of the first run, or leave the scene away: the checkpoint has it",
               "--resume"};
}

CheckpointWriter::CheckpointWriter(const Prepared& prepared, std::string out_dir)
    : prepared_(prepared), out_dir_(std::move(out_dir)) {}

Status CheckpointWriter::take(Role role, const exchange::Frame& frame, const Collector& collector,
                              const json& commands) {
  const auto which = static_cast<std::size_t>(role);
  Parts& parts = pending_[frame.head.step];
  parts.seal[which] = frame.checkpoint();
  parts.mark[which] = collector.mark(role);
  if ((prepared_.fluid && !parts.seal[0]) || (prepared_.rigid && !parts.seal[1])) return ok();
  const Status written = write(frame.head.step, frame.head.time, parts, collector, commands);
  pending_.erase(pending_.begin(), pending_.upper_bound(frame.head.step));
  if (written) prune();
  return written;
}

Status CheckpointWriter::write(std::uint64_t step, double time, const Parts& parts, const Collector& collector,
                               const json& commands) {
  RunPart run;
  run.step = step, run.time = time;
  run.scene_name = prepared_.scene.name, run.scene_text = print_scene(prepared_.scene);
  for (std::size_t k = 0; k < 2; ++k)
    if (parts.seal[k]) run.parts[kPartNames[k]] = {{"bytes", parts.seal[k]->bytes}, {"hash", parts.seal[k]->hash}};
  run.commands = json::array();
  for (const json& command : commands)
    if (command.contains("step") && command["step"] <= step) run.commands.push_back(command);
  run.collected = collector.snapshot(parts.mark[0], parts.mark[1]);
  const auto seal =
      checkpoint::write_part(checkpoint::folder_of(out_dir_, step), checkpoint::kRunPart, checkpoint::save(run));
  if (!seal) return seal.error();
  ++written_;
  return ok();
}

void CheckpointWriter::prune() const {
  int whole = 0;
  for (const fs::path& folder : folders(out_dir_)) {
    std::error_code failed;
    if (!fs::exists(folder / checkpoint::kRunPart, failed)) continue;  // under way
    if (++whole > prepared_.scene.output.checkpoint_keep) fs::remove_all(folder, failed);
  }
}

void CheckpointWriter::clear_unfinished() const {
  for (const fs::path& folder : folders(out_dir_)) {
    std::error_code failed;
    if (!fs::exists(folder / checkpoint::kRunPart, failed)) fs::remove_all(folder, failed);
  }
}

}  // namespace ballast::launch
