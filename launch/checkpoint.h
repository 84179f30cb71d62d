// Checkpoints as the coordinator sees them: the processes write their parts at the same border of a step; once all
// parts of a step are there, the coordinator writes its own, which names them. What has no such part is no checkpoint.
#pragma once
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/checkpoint/part.h"
#include "launch/collect.h"
#include "launch/prepare.h"

namespace ballast::launch {

/// A checkpoint that was found whole.
struct Checkpoint {
  std::string folder;  ///< absolute, of this one
  std::string out;     ///< of the run that wrote it
  std::uint64_t step = 0;
  double time = 0;  ///< s
  std::string scene_name, scene_text;
  Collector::Snapshot collected;
  nlohmann::json commands = nlohmann::json::array();  ///< up to this step, as in the record
  std::vector<std::string> refused;                   ///< newer ones that could not be used, and why
};

/// The newest whole checkpoint of a run's output folder. Error 2: there is none, with the reasons.
Result<Checkpoint> newest_checkpoint(const std::string& out_dir);

/// The scene of a resumed run must be that of the checkpoint, except for keys that change no result (outputs for
/// people, messages, checkpoints, expectations). Error 2 with the keys that differ.
Status same_scene(const Checkpoint& checkpoint, const Scene& scene);

class CheckpointWriter {
 public:
  CheckpointWriter(const Prepared& prepared, std::string out_dir);
  /// Takes a kCheckpoint frame of a process after the collector has taken all frames before it. Once the last part of a
  /// step has come: writes the coordinator's and removes the oldest beyond output.checkpoint.keep.
  Status take(exchange::Role role, const exchange::Frame& frame, const Collector& collector,
              const nlohmann::json& commands);
  /// Removes what has no coordinator's part: the run ended before the other process had written.
  void clear_unfinished() const;
  std::uint64_t written() const { return written_; }

 private:
  struct Parts {
    std::optional<exchange::CheckpointPart> seal[2];
    Collector::Mark mark[2];
  };
  Status write(std::uint64_t step, double time, const Parts& parts, const Collector& collector,
               const nlohmann::json& commands);
  void prune() const;

  const Prepared& prepared_;
  std::string out_dir_;
  std::map<std::uint64_t, Parts> pending_;
  std::uint64_t written_ = 0;
};

}  // namespace ballast::launch
