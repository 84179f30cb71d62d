// rigid_client --attach NAME [--engine ode]: the rigid process of a run whose segment exists.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/exchange/process.h"
#include "rigid_client/client.h"
#include "rigid_client/engine.h"

int main(int argc, char** argv) {
  CLI::App app{
      "The rigid process of a Ballast run. Normally started by `ballast run`; by hand with `ballast run --by-hand`."};
  std::string name, engine = ballast::engine_names().front();
  bool about = false;
  auto* attach = app.add_option("--attach", name, "name of the run's shared-memory segment");
  app.add_flag("--about", about, "print the engines, and end")->excludes(attach);
  app.add_option("--engine", engine, "rigid-body engine")->capture_default_str();
  try {
    app.parse(argc, argv);
    if (!about && name.empty()) throw CLI::RequiredError("--attach");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ballast::kFine : ballast::kBadInput;
  }
  if (about) {
    for (const std::string& one : ballast::engine_names()) {
      auto made = ballast::make_engine(one);
      if (!made) return made.error().exit_code;
      std::printf("%s\n", (*made)->describe().c_str());
    }
    return ballast::kFine;
  }
  ballast::exchange::end_with_coordinator("rigid_client");
  auto segment = ballast::exchange::Segment::attach(name, ballast::exchange::Role::kRigid);
  if (!segment) {
    std::fprintf(stderr, "rigid_client: %s\n", segment.error().text().c_str());
    return segment.error().exit_code;
  }
  const ballast::Status outcome = ballast::rigid::serve(*segment, engine);
  if (outcome) return ballast::kFine;
  std::fprintf(stderr, "rigid_client: %s\n", outcome.error().text().c_str());
  return outcome.error().exit_code;
}
