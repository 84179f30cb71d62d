// The loop of the rigid process. One step reads: receive, (restore,) save, apply, step, read, answer, report.
#include "rigid_client/client.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "common/checkpoint/part.h"
#include "common/checkpoint/state.h"
#include "common/exchange/hash.h"
#include "common/exchange/sleep.h"
#include "rigid_client/client_report.h"
#include "rigid_client/engine.h"
#include "rigid_client/outside.h"

namespace ballast::rigid {

namespace {

using exchange::Order;

/// Seconds since its making.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

class Client {
 public:
  Client(exchange::Segment& segment, std::unique_ptr<Engine> engine)
      : segment_(segment),
        link_(segment),
        manifest_(segment.manifest()),
        engine_(std::move(engine)),
        report_(manifest_),
        outside_(manifest_),
        sleep_(manifest_),
        due_(segment.checkpoint_every()) {}

  Status run(bool coupled) {
    Stopwatch watch;
    if (auto loaded = engine_->load(manifest_); !loaded) return loaded;
    states_.resize(manifest_.bodies.size());
    wrenches_.assign(states_.size(), exchange::Wrench{});
    look();
    if (!segment_.resume_dir().empty()) {
      if (auto resumed = resume(); !resumed) return resumed;
    } else {
      if (auto begun = report_.begin(link_, states_); !begun) return begun;
      if (const std::string lacks = engine_->lacks(); !lacks.empty() && manifest_.shapes.size() > 1)
        report_.warn(link_, lacks);
    }
    timing_.start_s = watch.seconds();
    return coupled ? follow() : run_alone();
  }

  Status finish(const Status& outcome) {
    Status sent = outcome ? flush(false) : ok();
    if (outcome && sent) sent = report_.last(link_);
    const Status& end = outcome ? sent : outcome;
    timing_.waiting_s = link_.seconds_waited();
    timing_.wall_s = wall_.seconds();
    const std::string text = report_.json(engine_->describe(), timing_, end ? "" : end.error().text(), sleep_);
    if (auto given = link_.finish(end ? kFine : end.error().exit_code, text); !given) return given;
    return end;
  }

 private:
  /// Lockstep with the fluid. A step counts when the next order comes or the fluid has finished: until then it may be
  /// taken back, the last one too.
  Status follow() {
    exchange::Answer answer{};
    answer.step = segment_.first_step();
    answer.time = time_;
    answer.max_dt = std::numeric_limits<double>::infinity();
    answer.hash = exchange::state_hash(states_);
    if (auto sent = link_.send(answer, states_); !sent) return sent;
    for (;;) {
      const double waited = link_.seconds_waited();
      auto order = link_.receive(wrenches_, contacts_);
      if (!order) return order.error();
      if (order->flags & exchange::kEnd) return ok();
      if (order->flags & exchange::kRollBack) {
        if (auto restored = engine_->restore(saved_); !restored) return restored;
        outside_.restore(saved_pushes_);
        look();
        has_pending_ = false;
      }
      engine_->save(saved_);
      saved_pushes_ = outside_.save();
      if (order->flags & exchange::kAsleep) {
        stay(order->step, order->time + order->dt, order->dt);
      } else if (auto stepped = advance(order->step, order->iteration, order->time, order->dt); !stepped) {
        return stepped;
      }
      obey(link_.ordered_commands());
      next_.report.wall_wait = link_.seconds_waited() - waited;
      answer.step = order->step;
      answer.iteration = order->iteration;
      answer.time = next_.report.time;
      answer.hash = next_.report.hash;
      if (auto sent = link_.send(answer, states_); !sent) return sent;
      if (auto sent = flush(); !sent) return sent;  // saved_ is still the state at the end of the step reported here
      keep();
      if (order->contacts_lost > 0)
        report_.warn(link_, "contact patches were merged since their ring was full; wrenches are exact");
    }
  }

  Status run_alone() {
    const double dt = manifest_.world->rigid_step, duration = manifest_.world->duration;
    const auto steps = static_cast<std::uint64_t>(std::ceil(duration / dt * (1 - 1e-12)));
    for (std::uint64_t step = segment_.first_step() + 1; step <= steps; ++step) {
      const double waited = link_.seconds_waited();
      auto credit = link_.await_credit(step);
      if (!credit) return credit.error();
      if (!*credit) return ok();
      auto commands = link_.commands(step);
      if (!commands) return commands.error();
      const double time = static_cast<double>(step - 1) * dt;
      const double rest = duration - time;
      const double length = rest < dt * (1 - 1e-9) ? rest : dt;
      const Stopwatch watch;
      if (sleep_.until(time) > time) {
        stay(step, time + length, length);
        sleep_.slept(time, time + length);
      } else {
        if (auto stepped = advance(step, 0, time, length); !stepped) return stepped;
        sleep_.computed(time + length, states_, 0);
      }
      obey(*commands);
      sleep_.took(watch.seconds(), length);
      for (const exchange::Command& command : *commands) sleep_.command(command, time + length);
      next_.report.wall_wait = link_.seconds_waited() - waited;
      keep();
      if (due_possible() && step < steps) {
        engine_->save(saved_);
        saved_pushes_ = outside_.save();
      }
      if (auto sent = flush(step < steps); !sent) return sent;
    }
    return ok();
  }

  /// One exchange step: the wrenches act throughout, in as many engine steps as the scene asks for.
  Status advance(std::uint64_t step, std::uint32_t iteration, double time, double dt) {
    Stopwatch watch;
    const std::vector<exchange::BodyState> before = states_;
    if (outside_.pushes()) {
      acting_ = wrenches_;
      outside_.add_to(acting_, time);
      engine_->apply(acting_);
    } else {
      engine_->apply(wrenches_);
    }
    const std::uint32_t substeps = std::max(1u, manifest_.world->substeps);
    for (std::uint32_t i = 0; i < substeps; ++i) {
      link_.beat();
      if (auto stepped = engine_->step(time + dt * i / substeps, dt / substeps); !stepped) return stepped;
    }
    timing_.engine_s += watch.seconds();
    look();
    if (substeps > 1) mean_acceleration(before, dt);
    outside_.add_to(states_, time + dt);
    begin_report(step, time + dt, dt);
    next_.report.iteration = iteration;
    next_.report.wall_compute = watch.seconds();
    return ok();
  }

  /// A step slept through: the bodies stay as they are.
  void stay(std::uint64_t step, double end, double dt) {
    begin_report(step, end, dt);
    next_.asleep = true;
  }

  void begin_report(std::uint64_t step, double end, double dt) {
    next_.asleep = false;
    exchange::StepReport& r = next_.report;
    r = exchange::StepReport{};
    r.step = step;
    r.time = end;
    r.dt = dt;
    r.hash = exchange::state_hash(states_);
  }

  /// Commands take effect at the end of the step just advanced: what changes is in its answer.
  void obey(std::span<const exchange::Command> commands) {
    next_results_.clear();
    const double time = next_.report.time;
    for (const exchange::Command& command : commands) {
      next_results_.push_back({command, outside_.take(command, time, states_, *engine_)});
      std::vector<exchange::BodyState> before = states_;
      look();
      // Neither is a motion: the step's mean accelerations stay.
      for (std::size_t b = 0; b < states_.size(); ++b) std::copy_n(before[b].acceleration, 6, states_[b].acceleration);
      outside_.add_to(states_, time);
    }
    if (!commands.empty()) next_.report.hash = exchange::state_hash(states_);
  }

  void look() {
    Stopwatch watch;
    engine_->read(states_);
    engine_->mobility(states_);
    timing_.read_s += watch.seconds();
  }

  void mean_acceleration(const std::vector<exchange::BodyState>& before, double dt) {
    for (std::size_t b = 0; b < states_.size(); ++b) {
      for (int k = 0; k < 3; ++k) {
        states_[b].acceleration[k] = (states_[b].velocity[k] - before[b].velocity[k]) / dt;
        states_[b].acceleration[3 + k] = (states_[b].angular_velocity[k] - before[b].angular_velocity[k]) / dt;
      }
    }
  }

  /// Keeps the step just done for its report.
  void keep() {
    next_.states = states_;
    next_.wrenches = wrenches_;
    next_.contacts = contacts_.size();
    next_.force_mismatch = force_mismatch(wrenches_, contacts_);
    std::swap(pending_, next_);
    std::swap(pending_results_, next_results_);
    has_pending_ = true;
  }

  /// Reports the step kept before, which can no longer be taken back. `more`: another one follows, so that a checkpoint
  /// has a use; saved_ is the engine's state at the end of the step.
  Status flush(bool more = true) {
    if (!has_pending_) return ok();
    Stopwatch watch;
    has_pending_ = false;
    Status sent = report_.accept(link_, pending_);
    time_ = pending_.report.time;
    for (const Told& result : pending_results_) {
      if (sent) sent = link_.command_result(pending_.report.step, time_, result.command.id, result.refused);
      if (result.refused.empty() && result.command.kind == exchange::CommandKind::kGravity)
        report_.gravity(result.command.values);
    }
    pending_results_.clear();
    if (sent && more && due_.at(time_)) sent = write_checkpoint();
    timing_.report_s += watch.seconds();
    return sent;
  }

  bool due_possible() const { return segment_.checkpoint_every() > 0; }

  template <class A>
  void state(A& a) {
    a("time", time_), a("engine", saved_), a("pushes", saved_pushes_), a("report", report_), a("sleep", sleep_);
  }

  Status write_checkpoint() {
    const std::uint64_t step = pending_.report.step;
    checkpoint::StateWriter writer;
    state(writer);
    auto seal =
        checkpoint::write_part(checkpoint::folder_of(segment_.out_dir(), step), checkpoint::kRigidPart, writer.take());
    if (!seal) return seal.error();
    return link_.checkpoint(step, time_, {seal->bytes, seal->hash});
  }

  Status resume() {
    auto part = checkpoint::read_part(segment_.resume_dir(), checkpoint::kRigidPart);
    if (!part) return part.error();
    checkpoint::StateReader reader(*part);
    state(reader);
    if (auto read = reader.status(); !read) return read;
    if (auto restored = engine_->restore(saved_); !restored) return restored;
    outside_.restore(saved_pushes_);
    look();
    const StepRecord& last = report_.last_step();
    if (last.states.size() != states_.size() || last.report.step != segment_.first_step())
      return Error{
          fmt::format("the rigid process's part of the checkpoint is of step {} with {} bodies, not {} with {}",
                      last.report.step, last.states.size(), segment_.first_step(), states_.size()),
          "resume from another checkpoint", segment_.resume_dir()};
    states_ = last.states;  // an engine knows the acceleration of its last substep only
    due_ = checkpoint::Due(segment_.checkpoint_every(), time_);
    return report_.warn_again(link_);
  }

  Stopwatch wall_;
  exchange::Segment& segment_;
  exchange::RigidLink link_;
  exchange::ManifestView manifest_;
  std::unique_ptr<Engine> engine_;
  ClientReport report_;
  ClientReport::Timing timing_;
  /// What became of a command in the step just done; told once the step cannot be taken back.
  struct Told {
    exchange::Command command;
    std::string refused;
  };
  Outside outside_;
  std::vector<Outside::Push> saved_pushes_;
  std::vector<exchange::Wrench> acting_;  ///< the fluid's and those from outside
  std::vector<Told> next_results_, pending_results_;
  std::vector<exchange::BodyState> states_;
  std::vector<exchange::Wrench> wrenches_;
  std::vector<exchange::Contact> contacts_;
  std::vector<std::byte> saved_;
  exchange::Sleep sleep_;  // where there is no fluid: with one, its process decides
  checkpoint::Due due_;
  double time_ = 0;  ///< s, at the end of the step reported last
  StepRecord next_, pending_;
  bool has_pending_ = false;  ///< pending_ holds a step that is not reported yet
};

Status fail(exchange::Segment& segment, const Error& error) {
  exchange::RigidLink link(segment);
  const std::string text =
      ClientReport(segment.manifest()).json("none", {}, error.text(), exchange::Sleep(segment.manifest()));
  if (auto given = link.finish(error.exit_code, text); !given) return given;
  return error;
}

}  // namespace

Status serve(exchange::Segment& segment, const std::string& engine_name) {
  auto engine = make_engine(engine_name);
  if (!engine) return fail(segment, engine.error());
  Client client(segment, *std::move(engine));
  return client.finish(client.run(segment.has(exchange::Role::kFluid)));
}

}  // namespace ballast::rigid
