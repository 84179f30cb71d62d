// fluid_server --attach NAME: the fluid process of a run whose segment exists.
#include <omp.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>

#include "common/exchange/process.h"
#include "fluid_server/passes/passes.h"
#include "fluid_server/server.h"

int main(int argc, char** argv) {
  CLI::App app{
      "The fluid process of a Ballast run. Normally started by `ballast run`; by hand with `ballast run --by-hand`."};
  std::string name;
  bool about = false;
  auto* attach = app.add_option("--attach", name, "name of the run's shared-memory segment");
  app.add_flag("--about", about, "print what this build uses on this machine, and end")->excludes(attach);
  try {
    app.parse(argc, argv);
    if (!about && name.empty()) throw CLI::RequiredError("--attach");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ballast::kFine : ballast::kBadInput;
  }
  if (about) {
    std::printf("vector instructions %s, OpenMP threads on %d cores\n", ballast::fluid::simd_name(),
                omp_get_num_procs());
    return ballast::kFine;
  }
  // Threads that wait give way at once, and sleep after a millisecond: the cores are the rigid process's, too. The
  // runtime (LLVM's) reads this when it is first used.
  setenv("KMP_BLOCKTIME", "1", 0);
  ballast::exchange::end_with_coordinator("fluid_server");
  auto segment = ballast::exchange::Segment::attach(name, ballast::exchange::Role::kFluid);
  if (!segment) {
    std::fprintf(stderr, "fluid_server: %s\n", segment.error().text().c_str());
    return segment.error().exit_code;
  }
  const ballast::Status outcome = ballast::fluid::serve(*segment);
  if (outcome) return ballast::kFine;
  std::fprintf(stderr, "fluid_server: %s\n", outcome.error().text().c_str());
  return outcome.error().exit_code;
}
