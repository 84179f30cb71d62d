// The command line of `ballast`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <thread>

#include "common/scene/nearest.h"
#include "common/scene/unit.h"
#include "launch/bench.h"
#include "launch/children.h"
#include "launch/commands.h"
#include "launch/doctor.h"
#include "launch/lcm_commands.h"
#include "launch/run.h"
#include "launch/spy.h"

namespace {

using namespace ballast;

namespace fs = std::filesystem;

/// A bare name stands for scenes/NAME.yaml, here or in the source tree (the programs lie in its build/bin). One that is
/// nowhere is an error with the nearest name.
Result<std::string> find_scene(const std::string& given) {
  if (fs::exists(given)) return given;
  const std::string named = "scenes/" + given + ".yaml";
  if (fs::exists(named)) return named;
  const fs::path tree = fs::path(launch::program_folder()).parent_path().parent_path();
  for (const fs::path& path : {tree / named, tree / given}) {
    if (fs::exists(path)) return path.lexically_proximate(fs::current_path()).string();
  }
  std::vector<std::string> known;
  const fs::path folder = given.find('/') == std::string::npos ? tree / "scenes" : fs::path(given).parent_path();
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().extension() != ".yaml") continue;
    known.push_back(given.find('/') == std::string::npos ? entry.path().stem().string() : entry.path().string());
  }
  std::ranges::sort(known);
  return Error{fmt::format("there is no scene file '{}'", given),
               known.empty() ? "Check the path: its folder has no scene either." : scene::suggestion(given, known), ""};
}

/// Options that are short for --set.
struct Sugar {
  const char* option;
  const char* path;
  const char* help;
};
constexpr Sugar kSugar[] = {
    {"--duration", "world.duration", "simulated time, e.g. 5s"},
    {"--spacing", "world.spacing", "particle spacing, e.g. 2cm"},
    {"--engine", "coupling.engine", "rigid engine: ode, free_body"},
    {"--checkpoint", "output.checkpoint.every", "simulated time between checkpoints, e.g. 1s"},
    {"--scheme", "coupling.scheme", "coupling scheme: auto, interlinked, iterated, staggered"},
};

/// Options that every command with a scene has.
struct SceneArguments {
  std::string scene;
  std::vector<std::string> sets;
  std::string short_values[std::size(kSugar)];

  void add_to(CLI::App& command, bool needed = true) {
    command.add_option("SCENE", scene, "scene file, or name of a scene in scenes/")->required(needed);
    command.add_option("--set", sets, "set a value of the scene, e.g. --set fluids.water.viscosity=0.1")
        ->type_name("PATH=VALUE");
    for (std::size_t i = 0; i < std::size(kSugar); ++i) {
      command.add_option(kSugar[i].option, short_values[i], kSugar[i].help)->type_name("VALUE");
    }
  }
  /// In the order of --set, then the short forms as the overrides that they stand for.
  Overrides overrides() const {
    Overrides out;
    for (const std::string& set : sets) {
      const std::size_t at = set.find('=');
      if (at == std::string::npos || at == 0) {
        throw CLI::ValidationError("--set", "'" + set + "' is not PATH=VALUE, e.g. world.duration=2s");
      }
      out.emplace_back(set.substr(0, at), set.substr(at + 1));
    }
    for (std::size_t i = 0; i < std::size(kSugar); ++i) {
      if (!short_values[i].empty()) out.emplace_back(kSugar[i].path, short_values[i]);
    }
    return out;
  }
};

/// More threads than this are a slip of the hand: a few per core already gain nothing.
int most_threads() { return std::max(64, 4 * static_cast<int>(std::thread::hardware_concurrency())); }

/// Turns a time as in a scene, with or without its unit, into a number of seconds; returns what is wrong with it.
std::string to_seconds(std::string& text) {
  const auto time = scene::parse_measure(text, scene::kTime, 0);
  if (!time) return time.error().what;
  text = fmt::format("{}", time->value);
  return "";
}

/// Options of `run`.
struct RunArguments {
  launch::RunOptions options;
  bool picture = false, vtk = false, lcm = false;

  void add_to(CLI::App& run) {
    run.add_flag("--no-expect", options.no_expect,
                 "expect nothing, not even that the fluid stays: leave out the scene's expectations, e.g. for a "
                 "shorter --duration");
    run.add_option("--out", options.out, "folder for the outputs")->type_name("DIR");
    run.add_option("--threads", options.threads,
                   "threads of the fluid process (default: all cores, one where there are few particles)")
        ->check(CLI::Range(1, most_threads()));
    run.add_option("--timeout", options.timeout, "time without a sign of life before a process counts as hung, e.g. 5s")
        ->transform(CLI::Validator(to_seconds, ""))
        ->check(CLI::Range(0.2, 1e6))
        ->capture_default_str();
    run.add_option("--references", options.references, "folder with reference curves")
        ->type_name("DIR")
        ->check(CLI::ExistingDirectory);
    run.add_flag("--picture", picture, "draw picture.png of the last state (needs povray)");
    run.add_flag("--vtk", vtk, "write ParaView files at every output time");
    run.add_flag("--lcm", lcm, "send live messages over LCM (ballast watch, ballast tap, ballast spy)");
    run.add_option("--lcm-url", options.lcm_url, "the same, to this LCM URL (default: this machine only)")
        ->type_name("URL");
    run.add_flag("--lcm-commands", options.lcm_commands, "obey `ballast tell` from whoever sends there; with --lcm");
    run.add_option("--replay", options.replay,
                   "record of a run with commands: the same ones at the same steps, and its end")
        ->type_name("RECORD");
    run.add_option("--resume", options.resume,
                   "go on from the newest checkpoint in this output folder (see --checkpoint)")
        ->type_name("DIR");
    run.add_flag("--by-hand", options.by_hand, "print the commands of the two processes instead of starting them");
    run.add_flag("--left-out", options.left_out, "print what the run did without, and what that saved");
    run.add_flag("--quiet", options.quiet, "no progress, only the last five lines");
  }
  /// Adds the flags as the overrides that they stand for.
  void spell_out() {
    if (options.no_expect) options.overrides.emplace_back("expect", "[]");
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

/// One subcommand per action, each with the options that it needs.
CLI::App* add_tell(CLI::App& app, launch::RunCommand& command, std::string& url) {
  CLI::App* tell = app.add_subcommand(
      "tell", "tell a run with --lcm-commands what to do; takes effect at the next border of a step, see its record");
  tell->require_subcommand(1);
  tell->fallthrough();
  tell->add_option("--lcm-url", url, "LCM URL of the run")->type_name("URL");
  tell->add_option("--run", command.run, "process id of its coordinator, where several are heard")->type_name("PID");
  const auto action = [&](const char* name, const char* help) {
    CLI::App* one = tell->add_subcommand(name, help);
    one->callback([&command, name] { command.action = name; });
    return one;
  };
  action("pause", "begin no further step");
  command.steps = 1;
  action("step", "some steps more of a run that is paused")
      ->add_option("STEPS", command.steps, "how many more")
      ->check([](const std::string& n) {
        return n.find_first_not_of("0123456789") == n.npos && n != "0" ? "" : "steps must be 1 or more, not " + n;
      })
      ->capture_default_str();
  action("resume", "go on after a pause");
  action("stop", "end the run in good order");
  CLI::App* wrench = action("wrench", "push a body for a while, e.g. tell wrench crate --force 0 0 50 --for 0.1");
  wrench->add_option("BODY", command.body, "that moves freely")->required();
  wrench->add_option("--force", command.force, "N, world")->type_name("X Y Z");
  wrench->add_option("--torque", command.torque, "N m, world, about the centre of mass")->type_name("X Y Z");
  wrench->add_option("--for", command.duration, "of simulated time, in whole steps")->type_name("SECONDS")->required();
  CLI::App* pose = action("pose", "put a body somewhere else, its velocity kept; not into bodies or fluid");
  pose->add_option("BODY", command.body, "that moves freely, without joints")->required();
  pose->add_option("--position", command.position, "m, world, of the centre of mass")->type_name("X Y Z")->required();
  pose->add_option("--orientation", command.orientation, "quaternion of length 1 (default: not turned)")
      ->type_name("W X Y Z");
  action("gravity", "change the gravity of the world, e.g. tell gravity 0 0 -1.62")
      ->add_option("GRAVITY", command.gravity, "m/s^2, world")
      ->type_name("X Y Z")
      ->required();
  return tell;
}

/// Names of the commands, or the options of one.
std::vector<std::string> words_of(const CLI::App& app, bool options) {
  std::vector<std::string> out;
  if (!options)
    for (const CLI::App* command : app.get_subcommands({})) out.push_back(command->get_name());
  else
    for (const CLI::Option* option : app.get_options())
      for (const std::string& name : option->get_lnames()) out.push_back("--" + name);
  return out;
}

/// What CLI11 only calls unexpected, with the nearest name: exit code 2, or nothing if it is neither command nor
/// option.
std::optional<int> unknown_word(const CLI::App& app, int argc, char** argv) {
  if (argc < 2) return std::nullopt;
  const auto commands = words_of(app, false);
  const std::string first = argv[1];
  if (!first.starts_with("-") && std::ranges::find(commands, first) == commands.end()) {
    fmt::print(stderr, "ballast: there is no command '{}'\n  {}\n", first, scene::suggestion(first, commands));
    return kBadInput;
  }
  if (first.starts_with("-")) return std::nullopt;
  const CLI::App* command = app.get_subcommand(first);
  auto options = words_of(*command, true);
  if (const auto actions = words_of(*command, false); !actions.empty()) {
    const std::string action = argc > 2 ? argv[2] : "";
    if (std::ranges::find(actions, action) == actions.end()) {
      if (action.starts_with("-")) return std::nullopt;
      fmt::print(stderr, "ballast: {} {}\n  {}\n", first,
                 action.empty() ? "what?" : fmt::format("has no action '{}'", action),
                 scene::suggestion(action, actions));
      return kBadInput;
    }
    std::ranges::copy(words_of(*command->get_subcommand(action), true), std::back_inserter(options));
  }
  for (int i = 2; i < argc; ++i) {
    const std::string word = argv[i], name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || name == "--" || std::ranges::find(options, name) != options.end()) continue;
    fmt::print(stderr, "ballast: {} has no option '{}'\n  {}\n", first, name, scene::suggestion(name, options));
    return kBadInput;
  }
  return std::nullopt;
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
  arguments.add_to(*run, false);
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
  CLI::App* doctor = app.add_subcommand("doctor", "does this machine have what runs need; what cures it where not");
  std::string bench_out = "out/bench", filter;
  CLI::App* bench = app.add_subcommand("bench", "run the benchmarks and merge their figures into DIR/bench.json");
  bench->add_option("--out", bench_out, "folder for bench.json")->type_name("DIR")->capture_default_str();
  bench->add_option("--filter", filter, "only programs whose name contains this");

  CLI::App* report = app.add_subcommand("report", "run the validation cases: error against run time on one page");
  report->prefix_command();
  report->set_help_flag();

  try {
    app.parse(argc, argv);
    if (*run && arguments.scene.empty() && wanted.options.resume.empty())
      throw CLI::RequiredError("SCENE, or --resume DIR,");
    wanted.options.overrides = arguments.overrides();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0)
      if (const auto code = unknown_word(app, argc, argv)) return *code;
    return app.exit(error) == 0 ? kFine : kBadInput;
  }
  if (*watch || *tap) return launch::become_monitor({argv + 1, argv + argc});
  if (*doctor) return launch::doctor();
  if (*report) {  // a Python program, which launch/ballast starts instead of this one
    fmt::print(stderr, "ballast: 'report' is not a command of this program\n  start it as ./launch/ballast report\n");
    return kBadInput;
  }
  if (*spy) return launch::spy(spy_url);
  if (*tell) return launch::tell(command, tell_url);
  launch::RunOptions& options = wanted.options;
  wanted.spell_out();
  if (!arguments.scene.empty()) {
    const auto scene_file = find_scene(arguments.scene);
    if (!scene_file) {
      fmt::print(stderr, "ballast: {}\n", scene_file.error().text());
      return kBadInput;
    }
    options.scene = *scene_file;
  }

  if (*run) return launch::run(options);
  if (*check) return launch::check(options.scene, options.overrides);
  if (*resolve) return launch::resolve(options.scene, options.overrides);
  if (*plan) return launch::plan(options.scene, options.overrides);
  if (*schema) return launch::schema();
  return launch::bench(bench_out, filter);
}
