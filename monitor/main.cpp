// ballast_monitor watch | tap: what `ballast watch` and `ballast tap` become. It only listens.
#include <CLI/CLI.hpp>

#include "common/result.h"
#include "monitor/tap.h"
#include "monitor/watch.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Watches runs that send messages (ballast run SCENE --lcm). It only listens: a monitor, however slow, changes no "
      "result."};
  app.name("ballast");
  app.require_subcommand(1);
  ballast::monitor::WatchOptions watching;
  ballast::monitor::TapOptions tapping;
  const char* where = "LCM URL to listen at (default: LCM_DEFAULT_URL, else this machine); file://LOG replays a log";
  CLI::App* watch = app.add_subcommand("watch", "one screen of text about the run; Ctrl-C ends it");
  watch->add_option("--lcm-url", watching.url, where)->type_name("URL");
  watch->add_flag("--once", watching.once, "print one screen and end");
  watch->add_option("--patience", watching.patience, "seconds to wait for a message, with --once")
      ->capture_default_str();
  CLI::App* tap = app.add_subcommand("tap", "print the messages of one channel, each entry of a list as a row");
  tap->add_option("CHANNEL", tapping.channel, "BALLAST_STATUS, _BODIES, _WRENCHES, _CONTACTS, _FLUID, _PARTICLES, ...")
      ->required();
  tap->add_flag("--csv", tapping.csv, "as CSV with a head line (default: name=value)");
  tap->add_option("--lcm-url", tapping.url, where)->type_name("URL");
  tap->add_option("--messages", tapping.messages, "end after so many messages")->type_name("N");
  tap->add_option("--seconds", tapping.seconds, "end after so long")->type_name("S");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ballast::kFine : ballast::kBadInput;
  }
  return *watch ? ballast::monitor::watch(watching) : ballast::monitor::tap(tapping);
}
