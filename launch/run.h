// `ballast run`: one scene from file to outputs, with an exit code that says how it went.
#pragma once
#include <string>
#include <vector>

#include "common/scene/reader.h"

namespace ballast::launch {

struct RunOptions {
  std::string scene;  ///< empty: that of the checkpoint
  Overrides overrides;
  std::string lcm_url;                  ///< where messages go; empty: LCM_DEFAULT_URL, else this machine only
  std::string out;                      ///< folder for outputs; empty: out/<scene>
  bool lcm_commands = false;            ///< obey commands over LCM
  std::string replay;                   ///< record of a run with commands; empty: none
  std::string resume;                   ///< output folder of a run with checkpoints; empty: from the start
  bool no_expect = false;               ///< nothing is expected, no loss of fluid is a miss
  int threads = 0;                      ///< of the fluid process; 0: as many as pay
  double timeout = 30;                  ///< s without a sign of life before a process counts as hung
  bool by_hand = false;                 ///< print the commands of the two processes instead of starting them
  bool quiet = false;                   ///< no progress
  bool left_out = false;                ///< print the table of what the run did without
  std::vector<std::string> references;  ///< folders with reference curves; empty: the usual places
};

/// Runs and prints; returns the exit code.
int run(const RunOptions& options);

}  // namespace ballast::launch
