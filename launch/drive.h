// The coordinator's loop: credit out, frames in, until both processes have finished or one has failed.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "common/exchange/link.h"
#include "common/result.h"
#include "launch/act.h"
#include "launch/checkpoint.h"
#include "launch/children.h"
#include "launch/collect.h"
#include "launch/lcm_commands.h"
#include "launch/prepare.h"
#include "launch/publish.h"

namespace ballast::launch {

/// How a run ended.
struct Outcome {
  int exit = kFine;
  bool interrupted = false;
  std::string stopped_by;                             ///< interrupted: by which signal, "SIGTERM"
  nlohmann::json commands = nlohmann::json::array();  ///< those that came, with the step
  std::optional<std::uint64_t> stopped_after;         ///< step after which a command ended the run
  std::string message;                                ///< empty if fine
  std::optional<std::uint64_t> resumed_after;         ///< step of the checkpoint that the run went on from
  double resumed_time = 0;                            ///< s, of it
  std::uint64_t checkpoints = 0;                      ///< written
  double wall_s = 0;                                  ///< from the start of the processes to the last step report
  double total_s = 0;                                 ///< ... to the end of both processes (pictures included)
  nlohmann::json fluid = nlohmann::json::object(), rigid = nlohmann::json::object();  ///< final reports
  nlohmann::json lcm;  ///< of the publisher, if there is one
};

struct DriveOptions {
  bool by_hand = false, quiet = false;
  CommandListener* commands = nullptr;           ///< null: nobody may give any
  std::optional<std::uint64_t> stop_after = {};  ///< replay of a run that was stopped: its last step
  Publisher* publisher = nullptr;                ///< null: nobody wants messages
  double timeout = 30;                           ///< s without a sign of life before a process counts as hung
  CheckpointWriter* checkpoints = nullptr;       ///< null: none are written
  std::vector<Replay::At> replay = {};           ///< commands of a run that is replayed
  const Checkpoint* resumed = nullptr;           ///< that the run goes on from
};

/// Drives a run whose processes have been started (or will be, by hand). Ctrl-C, SIGTERM and SIGHUP stop it in good
/// order.
Outcome drive(exchange::Segment& segment, Children& children, const Prepared& prepared, Collector& collector,
              const DriveOptions& options);

}  // namespace ballast::launch
