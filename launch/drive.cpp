// The coordinator sits on no critical path: it grants thousands of steps ahead and sleeps between looks at the rings.
#include "launch/drive.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <thread>
#include <utility>

#include "launch/progress.h"
#include "launch/say.h"
#include "launch/schedule.h"

namespace ballast::launch {

using exchange::Control;
using exchange::PeerState;
using exchange::Role;
using nlohmann::json;

namespace {

constexpr double kAttachTimeout = 30;     // s for a started process to attach
constexpr double kGraceAfterDeath = 0.3;  // s for the partner of a dead process; its own peer test takes 0.1 s
constexpr double kGraceAfterEnd = 2;      // s for a process to exit after its final report
constexpr double kGraceAfterStop = 20;    // s for a step under way when the run is stopped
constexpr auto kNap = std::chrono::milliseconds(50);

volatile std::sig_atomic_t signals_seen = 0, first_signal = 0;

/// Counts SIGINT, SIGTERM and SIGHUP while it lives.
class StopSignals {
 public:
  StopSignals() {
    signals_seen = 0;
    struct sigaction action {};
    action.sa_handler = [](int number) {
      if (signals_seen == 0) first_signal = number;
      signals_seen = signals_seen + 1;
    };
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &old_[i]);
    signal(SIGPIPE, SIG_IGN);  // `ballast run | head`: who reads may go, the run goes on
  }
  ~StopSignals() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &old_[i], nullptr);
  }

 private:
  static constexpr std::array<int, 3> kSignals = {SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, 3> old_{};
};

const char* state_name(PeerState state) {
  switch (state) {
    case PeerState::kAbsent:
      return "absent";
    case PeerState::kRunning:
      return "running";
    case PeerState::kFinished:
      return "finished";
    case PeerState::kDead:
      return "dead";
  }
  return "unknown";
}

class Driver {
 public:
  Driver(exchange::Segment& segment, Children& children, const Prepared& prepared, Collector& collector,
         const DriveOptions& options)
      : segment_(segment),
        control_(segment),
        children_(children),
        prepared_(prepared),
        collector_(collector),
        options_(options),
        progress_(options.quiet),
        obey_(options.stop_after, options.resumed ? options.resumed->commands : json::array()),
        start_(Clock::now()) {
    if (options.resumed) outcome_.resumed_after = options.resumed->step, outcome_.resumed_time = options.resumed->time;
    if (prepared.fluid) roles_.push_back(Role::kFluid);
    if (prepared.rigid) roles_.push_back(Role::kRigid);
  }

  Outcome run() {
    for (const Replay::At& at : options_.replay)  // those up to a checkpoint are in it
      if (at.step > outcome_.resumed_after.value_or(0)) warn(act_.take(at.command, at.step, 0, 0));
    grant();
    while (!all_ended()) {
      control_.wait_for_news(kNap);
      children_.poll();
      if (!look()) break;
      forget_name();
      obey();
      grant();
      react_to_signals();
      show();
      publish();
      bool fine = true;
      for (Role role : roles_) fine = alive_or_finished(role) && fine;  // each must get its say in the message
      fine = fine && outcome_.exit == kFine && !any_silent();
      if (!fine) break;
    }
    finish();
    return std::move(outcome_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  bool all_ended() const {
    return std::ranges::all_of(roles_, [this](Role r) { return control_.state(r) == PeerState::kFinished; });
  }

  void fail(int code, const std::string& message) {
    if (outcome_.exit == kFine) outcome_.exit = code;
    outcome_.message += (outcome_.message.empty() ? "" : "\n") + message;
  }

  /// Takes what has come in. False: it was wrong, and the run must end.
  bool look() {
    for (Role role : roles_) {
      frames_.clear();
      Status drained = control_.drain(role, frames_);
      for (std::size_t i = 0; drained && i < frames_.size(); ++i) {
        drained = collector_.take(role, frames_[i]);
        if (drained && options_.checkpoints && frames_[i].head.kind == exchange::FrameKind::kCheckpoint)
          drained = options_.checkpoints->take(role, frames_[i], collector_, obey_.record());
        if (frames_[i].head.kind == exchange::FrameKind::kCommand) warn(act_.result(frames_[i]));
        if (options_.publisher) options_.publisher->take(role, std::move(frames_[i]));  // last: it takes the frame over
      }
      if (!drained) {
        fail(kProcessFailed, drained.error().text());
        return false;
      }
      // Of the process that begins steps: the other's last report comes when the first has ended, its picture drawn.
      if (!frames_.empty() && role == roles_.front()) outcome_.wall_s = elapsed();
    }
    return true;
  }

  /// Last step done by the process that begins them. Not what both have reported: the rigid process reports a step only
  /// when the next order comes, and in a pause none does.
  const exchange::StepReport& done() const { return collector_.totals(roles_.front()).last; }

  /// A warning of our own, as those of the processes.
  void warn(const std::string& text) {
    if (text.empty()) return;
    const auto bytes = std::as_bytes(std::span(text));
    exchange::Frame frame{
        {exchange::FrameKind::kWarning, static_cast<std::uint32_t>(bytes.size()), done().step, done().time},
        {bytes.begin(), bytes.end()}};
    if (const Status taken = collector_.take(Role::kCoordinator, frame); !taken)
      fail(kProcessFailed, taken.error().text());
    if (options_.publisher) options_.publisher->take(Role::kCoordinator, std::move(frame));
  }

  void obey() {
    if (options_.commands) {
      for (const RunCommand& c : options_.commands->take()) {
        if (acts(c))
          warn(act_.take(c, 0, done().step, done().time));
        else
          obey_.take(c, done().step, done().time);
      }
    }
    if (stopping_ || !obey_.stop_due(done().step)) return;
    stopping_ = commanded_ = true;
    control_.stop();
  }

  void grant() {
    if (stopping_) return;
    if (const auto limit = obey_.limit()) {
      // Lower than what was granted: steps begun go on, no other begins.
      const std::uint64_t credit = std::min(*limit, collector_.reported() + kRunAhead);
      if (credit != granted_) control_.grant(granted_ = credit);
      return;
    }
    if (const auto credit = next_credit(granted_, collector_.reported(), kRunAhead)) {
      granted_ = *credit;
      control_.grant(granted_);
    }
  }

  void react_to_signals() {
    if (signals_seen == 0) return;
    if (!stopping_) {
      stopping_ = true;
      outcome_.interrupted = true;
      outcome_.stopped_by = std::string("SIG") + sigabbrev_np(first_signal);
      stop_time_ = elapsed();
      progress_.clear();
      say(stderr, "{}: stopping after the step under way (once more to stop at once)\n", outcome_.stopped_by);
      control_.stop();
    }
    if (signals_seen > 1 || elapsed() - stop_time_ > kGraceAfterStop) children_.end_all();
    // By hand there may be nobody yet to stop.
    for (Role role : roles_)
      if (options_.by_hand && control_.state(role) == PeerState::kAbsent)
        fail(kProcessFailed,
             fmt::format("stopped by {} before the {} had attached", outcome_.stopped_by, exchange::role_name(role)));
  }

  /// Only the fluid chooses steps.
  std::string limit_name(const exchange::StepReport& report) const {
    if (roles_.front() != exchange::Role::kFluid || report.limit >= exchange::kStepLimits.size()) return "";
    return exchange::kStepLimits[report.limit];
  }

  void show() {
    const StepTotals& totals = collector_.totals(roles_.front());
    progress_.show({.time = totals.last.time,
                    .duration = prepared_.scene.world.duration,
                    .dt = totals.last.dt,
                    .wall = elapsed(),
                    .limit = limit_name(totals.last),
                    .steps = totals.steps,
                    .particles = totals.last.particles,
                    .first = outcome_.resumed_time,
                    .errors = collector_.errors()});
  }

  void publish() {
    if (!options_.publisher || !options_.publisher->status_due()) return;
    const bool begun = collector_.totals(roles_.front()).steps > 0;
    options_.publisher->status(run_status(obey_.paused() ? "paused" : begun ? "running" : "starting"));
  }

  RunStatus run_status(const char* state) const {
    const StepTotals& totals = collector_.totals(roles_.front());
    RunStatus s;
    s.state = state;
    s.last = totals.last;
    s.errors = collector_.errors();
    s.steps = totals.steps;
    s.wall = elapsed();
    s.first_time = outcome_.resumed_time;
    for (Role role : roles_) {
      const StepTotals& own = collector_.totals(role);
      (role == Role::kFluid ? s.fluid : s.rigid) = {control_.pid(role), state_name(control_.state(role)), own.compute_s,
                                                    own.wait_s};
    }
    s.warnings = collector_.warnings().size();
    s.run = getpid();
    s.obeys = options_.commands != nullptr;
    s.exit_code = outcome_.exit;
    return s;
  }

  /// False if the process is gone without having finished, or never came.
  bool alive_or_finished(Role role) {
    const PeerState state = control_.state(role);
    if (state == PeerState::kFinished) return control_.exit_code(role) == kFine;
    const bool gone = children_.started(role) && !children_.running(role);
    if (gone && control_.state(role) == PeerState::kFinished) return control_.exit_code(role) == kFine;
    if (outcome_.interrupted && gone) return false;
    if (state == PeerState::kDead || gone) {
      if (std::exchange(reported_dead_[static_cast<std::size_t>(role)], true)) return false;
      // The partner may find it dead before the kernel lets it be reaped: how it ended is worth a moment.
      for (int k = 0; k < 20 && children_.started(role) && children_.running(role); ++k, children_.poll())
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      std::string how = children_.how_ended(role);
      if (how.empty()) how = "is gone";
      fail(kProcessFailed, fmt::format("the {}{} {} at t = {:.4g} s\n  start again; if nobody ended it on purpose, see "
                                       "its output above and the kernel's log (dmesg) for a kill for want of memory",
                                       exchange::role_name(role),
                                       control_.pid(role) > 0 ? fmt::format(" (pid {})", control_.pid(role)) : "", how,
                                       collector_.totals(role).last.time));
      return false;
    }
    if (state == PeerState::kAbsent && !options_.by_hand && elapsed() > kAttachTimeout) {
      fail(kProcessFailed, fmt::format("the {} did not attach within {} s", exchange::role_name(role), kAttachTimeout));
      return false;
    }
    return true;
  }

  /// A process that has not moved its heartbeat for the time-out is stopped or hangs. The two find that of each other;
  /// this is for one without a partner, and for both at once.
  bool any_silent() {
    // Time in which the coordinator was stopped itself is nobody's silence.
    const double now = elapsed(), awake = std::min(now - last_look_, 2 * std::chrono::duration<double>(kNap).count());
    last_look_ = now;
    // With two, each gets the time to say it of the other: it knows the step.
    const double limit = options_.timeout * (roles_.size() > 1 ? 1.5 : 1.0);
    bool silent = false;
    for (Role role : roles_) {
      Silence& s = silences_[static_cast<std::size_t>(role)];
      const std::uint64_t beat = control_.heartbeat(role);
      const bool counts = control_.state(role) == PeerState::kRunning && beat == s.beat;
      s.seconds = counts ? s.seconds + awake : 0;
      s.beat = beat;
      if (s.seconds < limit) continue;
      fail(kProcessFailed,
           fmt::format("the {} (pid {}) is alive but has shown no sign of life for {:.3g} s at t = {:.4g} "
                       "s\n  it is stopped or hangs; if its steps really take that long, raise --timeout",
                       exchange::role_name(role), control_.pid(role), s.seconds, collector_.totals(role).last.time));
      silent = true;
    }
    return silent;
  }

  /// By hand the segment needs its name until all have attached.
  void forget_name() {
    const auto absent = [this](Role r) { return control_.state(r) == PeerState::kAbsent; };
    if (name_gone_ || std::ranges::any_of(roles_, absent)) return;
    segment_.forget_name();
    name_gone_ = true;
  }

  /// Ends what still runs and reads the final reports.
  void finish() {
    progress_.clear();
    control_.stop();
    children_.wait(all_ended() ? kGraceAfterEnd : kGraceAfterDeath);
    for (Role role : roles_) {
      if (!children_.running(role)) alive_or_finished(role);  // names one that died unnoticed so far
    }
    children_.end_all();
    look();
    if (options_.checkpoints) {
      options_.checkpoints->clear_unfinished();
      outcome_.checkpoints = options_.checkpoints->written();
    }
    outcome_.total_s = elapsed();
    if (outcome_.interrupted) fail(kProcessFailed, "stopped by " + outcome_.stopped_by);
    if (commanded_) outcome_.stopped_after = done().step;
    act_.close(outcome_.exit != kFine);
    obey_.close();
    outcome_.commands = obey_.record();
    int worst = kFine;
    std::string messages;
    for (Role role : roles_) {
      if (control_.state(role) != PeerState::kFinished) continue;
      (role == Role::kFluid ? outcome_.fluid : outcome_.rigid) = parse(role);
      const int code = control_.exit_code(role);
      // A process that ends because its partner did says 5; the partner's own reason counts more.
      if (code == kFine || (worst != kFine && code == kProcessFailed)) continue;
      worst = code;
      const json& report = role == Role::kFluid ? outcome_.fluid : outcome_.rigid;
      messages = fmt::format("the {} ended with exit code {}", exchange::role_name(role), code);
      for (const char* key : {"failure", "error"}) {
        if (report.contains(key) && report[key].is_string()) messages = in_the_file(prepared_, report[key]);
      }
    }
    if (worst != kFine && outcome_.exit == kFine) fail(worst, messages);
    if (options_.publisher)
      outcome_.lcm = options_.publisher->close(run_status(outcome_.exit == kFine ? "finished" : "failed"));
  }

  json parse(Role role) {
    json report = json::parse(control_.final_report(role), nullptr, false);
    if (report.is_object()) return report;
    fail(kProcessFailed, fmt::format("the final report of the {} is not JSON", exchange::role_name(role)));
    return json::object();
  }

  exchange::Segment& segment_;
  Control control_;
  Children& children_;
  const Prepared& prepared_;
  Collector& collector_;
  DriveOptions options_;
  Progress progress_;
  Obey obey_;
  Act act_{control_, prepared_, obey_};
  StopSignals signals_;
  bool commanded_ = false;  // stopping because of a command
  Clock::time_point start_;
  std::vector<Role> roles_;
  std::vector<exchange::Frame> frames_;
  std::uint64_t granted_ = 0;
  bool stopping_ = false;
  std::array<bool, 2> reported_dead_{};
  struct Silence {
    std::uint64_t beat = 0;
    double seconds = 0;
  };
  std::array<Silence, 2> silences_{};
  double last_look_ = 0;
  bool name_gone_ = false;
  double stop_time_ = 0;
  Outcome outcome_;
};

}  // namespace

Outcome drive(exchange::Segment& segment, Children& children, const Prepared& prepared, Collector& collector,
              const DriveOptions& options) {
  return Driver(segment, children, prepared, collector, options).run();
}

}  // namespace ballast::launch
