// Commands that act on bodies or the world: checked against the scene, handed to the processes, and kept for the record
// with what became of them. A recorded run's are replayed at the same steps.
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/exchange/link.h"
#include "launch/obey.h"
#include "launch/prepare.h"

namespace ballast::launch {

/// True for wrench, pose and gravity: those that the processes carry out.
bool acts(const RunCommand& command);

/// As the processes understand it, with id and step 0. An error says why not: unknown or fixed body, a number that is
/// not finite, a length of 0 where there must be one.
Result<exchange::Command> to_exchange(const RunCommand& command, const Prepared& prepared);

/// Body and values of a command, as the record has them and replays read them.
nlohmann::json to_json(const RunCommand& command);
Result<RunCommand> from_json(const nlohmann::json& entry);

/// Hands commands that act to the processes and books what became of them. What take() and result() return is a warning
/// to send: why a command was refused; empty where it was not.
class Act {
 public:
  Act(exchange::Control& control, const Prepared& prepared, Obey& book)
      : control_(control), prepared_(prepared), book_(book) {}

  /// `step`: at whose end it takes effect; 0: of the next one to begin. `done` and `time` are where the run stands.
  std::string take(const RunCommand& command, std::uint64_t step, std::uint64_t done, double time);
  /// A frame of kind kCommand.
  std::string result(const exchange::Frame& frame);
  /// The run has ended: what has not been answered came too late, or, if it `failed`, may have taken effect.
  void close(bool failed);

 private:
  exchange::Control& control_;
  const Prepared& prepared_;
  Obey& book_;
  std::vector<std::size_t> place_;  // in the book, of command id - 1
  std::vector<bool> answered_;
};

/// What a record says about how to run again.
struct Replay {
  struct At {
    std::uint64_t step;
    RunCommand command;
  };
  std::optional<std::uint64_t> stop_after;  ///< step after which a command ended the run
  std::vector<At> commands;                 ///< those that took effect, in order
  std::string motion_hash;                  ///< of the run's scene; empty: a list of commands written by hand
};
/// Hash of all of a scene that its motion hangs on: not what is written, probes and expectations.
std::string motion_hash(Scene scene);
/// Refuses to replay a run of another scene.
Status same_motion(const Replay& replay, const Scene& scene);
Result<Replay> read_replay(const std::string& record_file);

}  // namespace ballast::launch
