// `ballast doctor`: does this machine have what a run needs, and what cures it where it has not.
#pragma once
#include <string>
#include <vector>

#include "common/result.h"

namespace ballast::launch {

/// What one look found.
struct Finding {
  enum class State {
    kFine,    ///< there, and it works
    kAbsent,  ///< an optional part is missing: runs work without it
    kFault    ///< no run would work
  };
  State state = State::kFine;
  std::string what;  ///< a word or two: "shared memory"
  std::string seen;  ///< what was found, with figures
  std::string cure;  ///< empty where it is fine
};

/// "ok      what: seen", or "absent  what: seen" and "FAULT   what: seen" with the cure on a line below.
std::string finding_text(const Finding& finding);
/// 0 if a run would work, 5 if not.
int doctor_verdict(const std::vector<Finding>& findings);

/// One message there and back over the LCM URL that runs send to by default; its text names the version and the URL.
/// The error has the cure.
Result<std::string> lcm_round_trip();

/// Looks at everything and prints it. Exit code.
int doctor();

}  // namespace ballast::launch
