// The command line of `ballast`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "launch/bench.h"
#include "launch/children.h"
#include "launch/commands.h"
#include "launch/lcm_commands.h"
#include "launch/run.h"
#include "launch/spy.h"

namespace {

using namespace ballast;

/// Options that every command with a scene has.
struct SceneArguments {
  std::string scene;
  std::vector<std::string> sets;

  void add_to(CLI::App& command) {
    command.add_option("SCENE", scene, "scene file, or name of a scene in scenes/")->required();
    command.add_option("--set", sets, "set a value of the scene, e.g. --set fluids.water.viscosity=0.1")
        ->type_name("PATH=VALUE");
  }
};

/// A bare name stands for scenes/NAME.yaml, here or in the source tree (the programs lie in its build/bin).
std::string find_scene(const std::string& given) {
  namespace fs = std::filesystem;
  if (fs::exists(given)) return given;
  const std::string named = "scenes/" + given + ".yaml";
  if (fs::exists(named)) return named;
  const fs::path tree = fs::path(launch::program_folder()).parent_path().parent_path();
  for (const fs::path& path : {tree / named, tree / given}) {
    if (fs::exists(path)) return path.lexically_proximate(fs::current_path()).string();
  }
  return given;
}

/// Options of `run` that are short for --set.
struct Sugar {
  const char* option;
  const char* path;
  const char* help;
};
constexpr Sugar kSugar[] = {
    {"--duration", "world.duration", "simulated time, e.g. 5s"},
    {"--spacing", "world.spacing", "particle spacing, e.g. 2cm"},
    {"--engine", "coupling.engine", "rigid engine: ode, free_body"},
    {"--scheme", "coupling.scheme", "coupling scheme: auto, interlinked, staggered"},
};

/// Options of `run`.
struct RunArguments {
  launch::RunOptions options;
  std::string short_values[std::size(kSugar)];
  bool picture = false, vtk = false, lcm = false;

  void add_to(CLI::App& run) {
    for (std::size_t i = 0; i < std::size(kSugar); ++i) {
      run.add_option(kSugar[i].option, short_values[i], kSugar[i].help)->type_name("VALUE");
    }
    run.add_option("--out", options.out, "folder for the outputs")->type_name("DIR");
    run.add_option("--threads", options.threads, "threads of the fluid process (default: all cores)")
        ->check(CLI::Range(1, 1024));
    run.add_option("--references", options.references, "folder with reference curves")->type_name("DIR");
    run.add_flag("--picture", picture, "draw picture.png of the last state (needs povray)");
    run.add_flag("--vtk", vtk, "write ParaView files at every output time");
    run.add_flag("--lcm", lcm, "send live messages over LCM (ballast watch, ballast tap, ballast spy)");
    run.add_option("--lcm-url", options.lcm_url, "the same, to this LCM URL (default: this machine only)")
        ->type_name("URL");
    run.add_flag("--lcm-commands", options.lcm_commands, "obey `ballast tell` from whoever sends there; with --lcm");
    run.add_option("--replay", options.replay, "record of a run stopped by a command: stop after the same step")
        ->type_name("RECORD");
    run.add_flag("--by-hand", options.by_hand, "print the commands of the two processes instead of starting them");
    run.add_flag("--quiet", options.quiet, "no progress, only the last five lines");
  }
  /// Writes the short forms as the overrides that they stand for.
  void spell_out() {
    for (std::size_t i = 0; i < std::size(kSugar); ++i) {
      if (!short_values[i].empty()) options.overrides.emplace_back(kSugar[i].path, short_values[i]);
    }
    if (picture) options.overrides.emplace_back("output.picture", "true");
    if (vtk) options.overrides.emplace_back("output.vtk", "true");
    if (lcm || options.lcm_commands || !options.lcm_url.empty()) options.overrides.emplace_back("output.lcm", "true");
  }
};

/// A command that ballast_monitor carries out, with options of its own.
CLI::App* add_monitor(CLI::App& app, const char* name, const char* help) {
  CLI::App* command = app.add_subcommand(name, help);
  command->set_help_flag();  // ballast_monitor prints it
  command->prefix_command();
  return command;
}

CLI::App* add_tell(CLI::App& app, launch::RunCommand& command, std::string& url) {
  CLI::App* tell = app.add_subcommand("tell", "pause, step, resume or stop a run with --lcm-commands");
  tell->add_option("ACTION", command.action, "at the next border of a step")
      ->required()
      ->check(CLI::IsMember({"pause", "step", "resume", "stop"}));
  command.steps = 1;
  tell->add_option("STEPS", command.steps, "how many more, for step")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  tell->add_option("--lcm-url", url, "LCM URL of the run")->type_name("URL");
  return tell;
}

Overrides overrides_of(const std::vector<std::string>& sets) {
  Overrides out;
  for (const std::string& set : sets) {
    const std::size_t at = set.find('=');
    if (at == std::string::npos || at == 0) {
      throw CLI::ValidationError("--set", "'" + set + "' is not PATH=VALUE, e.g. world.duration=2s");
    }
    out.emplace_back(set.substr(0, at), set.substr(at + 1));
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Ballast: water that pushes back. Runs a particle fluid and a rigid-body engine in lockstep.\n"
      "Exit codes: 0 fine, 2 bad input or usage, 3 an expectation missed, 4 diverged, 5 a process or the exchange "
      "failed."};
  app.name("ballast");
  app.set_version_flag("--version", BALLAST_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(32);

  SceneArguments arguments;
  RunArguments wanted;
  CLI::App* run = app.add_subcommand("run", "simulate a scene; outputs go to out/<scene>");
  arguments.add_to(*run);
  wanted.add_to(*run);

  CLI::App* check = app.add_subcommand("check", "read a scene, make its bodies, say what is wrong; no simulation");
  CLI::App* resolve = app.add_subcommand("resolve", "print the whole effective scene, defaults written out");
  CLI::App* plan = app.add_subcommand("plan", "print which processes run, what they write, what is left out and why");
  for (CLI::App* command : {check, resolve, plan}) arguments.add_to(*command);
  CLI::App* schema = app.add_subcommand("schema", "print the JSON Schema of scene files");
  CLI::App* watch = add_monitor(app, "watch", "one screen of text about a run with --lcm");
  CLI::App* tap = add_monitor(app, "tap", "print one channel of a run with --lcm, e.g. tap BALLAST_BODIES --csv");
  launch::RunCommand command;
  std::string tell_url;
  CLI::App* tell = add_tell(app, command, tell_url);
  CLI::App* spy = app.add_subcommand("spy", "lcm-spy: a window with every channel and field of runs with --lcm");
  std::string spy_url;
  spy->add_option("--lcm-url", spy_url, "LCM URL to listen at")->type_name("URL");
  std::string bench_out = "out/bench", filter;
  CLI::App* bench = app.add_subcommand("bench", "run the benchmarks and merge their figures into DIR/bench.json");
  bench->add_option("--out", bench_out, "folder for bench.json")->type_name("DIR")->capture_default_str();
  bench->add_option("--filter", filter, "only programs whose name contains this");

  try {
    app.parse(argc, argv);
    wanted.options.overrides = overrides_of(arguments.sets);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kFine : kBadInput;
  }
  if (*watch || *tap) return launch::become_monitor({argv + 1, argv + argc});
  if (*spy) return launch::spy(spy_url);
  if (*tell) return launch::tell(command, tell_url);
  launch::RunOptions& options = wanted.options;
  wanted.spell_out();
  options.scene = find_scene(arguments.scene);

  if (*run) return launch::run(options);
  if (*check) return launch::check(options.scene, options.overrides);
  if (*resolve) return launch::resolve(options.scene, options.overrides);
  if (*plan) return launch::plan(options.scene, options.overrides);
  if (*schema) return launch::schema();
  return launch::bench(bench_out, filter);
}
