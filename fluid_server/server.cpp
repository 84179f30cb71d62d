// The loop of the fluid process: credit, first half of the step, wrenches out, second half, states in, reports.
#include "fluid_server/server.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "common/checkpoint/part.h"
#include "common/checkpoint/state.h"
#include "common/exchange/hash.h"
#include "common/exchange/sleep.h"
#include "common/geometry/bodies.h"
#include "common/intervals.h"
#include "common/scene/reader.h"
#include "fluid_server/monitor_frames.h"
#include "fluid_server/post_mortem.h"
#include "fluid_server/probes/probes.h"
#include "fluid_server/report.h"
#include "fluid_server/step/interface.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

namespace {

using Clock = std::chrono::steady_clock;

/// Signs of life from a thread of its own, where somebody else works: the rigid process waits while povray draws.
class Beating {
 public:
  explicit Beating(exchange::Link& link)
      : thread_([&link](const std::stop_token& end) {
          while (!end.stop_requested()) link.beat(), std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }) {}

 private:
  std::jthread thread_;
};

class Server {
 public:
  Server(exchange::Segment& segment, Scene scene, std::vector<Body> bodies, std::unique_ptr<WcsphFluid> fluid)
      : segment_(segment),
        link_(segment),
        scene_(std::move(scene)),
        bodies_(std::move(bodies)),
        fluid_(std::move(fluid)),
        report_(scene_, bodies_, *fluid_, segment.out_dir()),
        sleep_(segment.manifest()),
        coupled_(segment.has(exchange::Role::kRigid)),
        interface_(scene_, bodies_, fluid_->implicit() || fluid_->scheme() == Scheme::kInterlinked) {
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      states_.push_back(initial_state(scene_.models[b], bodies_[b], scene_.world.gravity));
    limits_ = step_limits(scene_, bodies_, *fluid_);
    due_ = checkpoint::Due(segment.checkpoint_every());
    if (MonitorFrames::wanted(segment)) monitor_ = std::make_unique<MonitorFrames>(segment, scene_, *fluid_);
  }

  Status run() {
    const bool resumed = !segment_.resume_dir().empty();
    if (resumed)
      if (auto s = resume(); !s) return s;
    if (coupled_) {
      auto answer = link_.receive(step_, 0, states_);
      if (!answer) return answer.error();
      engine_bound_ = answer->max_dt;
    }
    link_.beat();
    if (!resumed) {
      report_.quiet(fluid_->quiet_start(states_));
      if (auto s = rows(true); !s) return s;
    }
    const double end = scene_.world.duration;
    while (time_ < end * (1 - 1e-12) && !stopped_) {
      if (auto s = one_step(end); !s) return s;
    }
    return ok();
  }

  Status finish(const Status& outcome) {
    if (auto s = rows(true); !s && outcome) return s;
    if (outcome && scene_.output.picture) {
      const Beating beating(link_);
      report_.write_final(states_, segment_.threads());
    }
    return link_.finish(outcome ? kFine : outcome.error().exit_code,
                        report_.json(step_, time_, stopped_, states_, link_, outcome, sleep_, interface_));
  }

 private:
  Status one_step(double end) {
    const auto start = Clock::now();
    const double waited = link_.seconds_waited();
    auto credit = link_.await_credit(step_ + 1);
    if (!credit) return credit.error();
    if (!*credit) {
      stopped_ = true;
      return ok();
    }
    if (auto s = take_commands(); !s) return s;
    const double until = std::min(sleep_.until(time_), end);
    Step step{until - time_, Limit::kAsleep};
    std::uint32_t iteration = 0;
    if (until > time_) {
      if (auto s = sleep(until, end); !s) return s;
    } else {
      step = choose_step(limits_, fluid_->facts(), coupled_ ? engine_bound_ : 1e300, time_, end);
      cut_ |= step.limit == Limit::kOutput;
      if (auto s = compute(step, iteration, end); !s) return s;
    }
    exchange::StepReport r = report_.step_report(step_, time_, step, exchange::state_hash(states_));
    r.iteration = iteration;
    r.wall_wait = link_.seconds_waited() - waited;
    r.wall_compute = std::chrono::duration<double>(Clock::now() - start).count() - r.wall_wait;
    sleep_.took(r.wall_compute + r.wall_wait, step.dt);
    if (auto s = link_.report(r); !s) return s;
    if (auto s = obey(); !s) return s;
    if (auto s = rows(false); !s) return s;
    return due_.at(time_) && !cut_ && time_ < end * (1 - 1e-12) ? write_checkpoint() : ok();
  }

  /// A step that is computed, as often as it takes; `step` and `iteration` become those of the try that was kept.
  Status compute(Step& step, std::uint32_t& iteration, double end) {
    for (std::uint32_t retry = 0;; ++iteration, ++retry) {
      if (auto s = try_step(step, iteration, end); !s) return s;
      const double most = limits_.most_move;
      if (fluid_->facts().max_move <= most || retry == kRetries) break;
      // Something was faster than the last step foretold: do the step again, shorter.
      fluid_->roll_back();
      states_ = states_before_;
      step = {step.dt * 0.5 * most / std::min(fluid_->facts().max_move + most, 1.0), Limit::kRetry};
    }
    ++step_;
    time_ += step.dt;
    last_limit_ = step.limit;
    if (!fluid_->facts().finite || fluid_->facts().max_speed > kMostMach * limits_.sound_speed) return diverged(step);
    report_.count(step.limit, states_before_, states_, step.dt, time_);
    if (coupled_) report_.interface(interface_, time_);
    if (report_.measured().compression_mean > kMostCompression ||
        report_.energy().share_now() > scene_.numerics.energy_bound)
      return diverged(step);
    sleep_.computed(time_, states_, fluid_->facts().max_speed);
    return ok();
  }

  /// A step to `until` that is slept through: particles, bodies and the forces between them stay as they are.
  Status sleep(double until, double end) {
    const double dt = until - time_;
    if (coupled_) {
      if (auto s = send(dt, 0, exchange::kAsleep, {}, end); !s) return s;
      if (auto answer = link_.receive(step_ + 1, 0, states_); !answer) return answer.error();
    }
    sleep_.slept(time_, until);
    ++step_;
    time_ = until;
    last_limit_ = Limit::kAsleep;
    report_.count_slept(dt, states_);
    return ok();
  }

  /// The order of the coming step, of length dt.
  Status send(double dt, std::uint32_t iteration, std::uint32_t flags, std::span<const exchange::Contact> contacts,
              double end) {
    if (iteration > 0) flags |= exchange::kRollBack;
    if (time_ + dt >= end * (1 - 1e-12)) flags |= exchange::kLast;
    exchange::Order order{};
    order.step = step_ + 1;
    order.iteration = iteration;
    order.flags = flags;
    order.time = time_;
    order.dt = order.next_dt = dt;
    return link_.send(order, fluid_->wrenches(), contacts, commands_);
  }

  /// Those that take effect at the end of the coming step; the rigid process gets them with the order. A body cannot be
  /// put where fluid is: what would become of the particles?
  Status take_commands() {
    auto commands = link_.commands(step_ + 1);
    if (!commands) return commands.error();
    commands_ = *std::move(commands);
    Status told = ok();
    std::erase_if(commands_, [&](const exchange::Command& c) {
      if (c.kind != exchange::CommandKind::kPose) return false;
      const double* v = c.values;
      const Pose pose{Vec3(v[0], v[1], v[2]), Quat(v[3], v[4], v[5], v[6]).normalized()};
      const std::size_t inside = count_inside(bodies_[c.body], pose, *fluid_);
      if (inside == 0) return false;
      if (told)
        told = link_.command_result(step_ + 1, time_, c.id, fmt::format("{} particles of fluid are there", inside));
      return true;
    });
    return told;
  }

  /// What commands change in the fluid, once the step is kept.
  Status obey() {
    for (const exchange::Command& c : commands_) {
      sleep_.command(c, time_);
      if (c.kind == exchange::CommandKind::kGravity) {
        const Measures before = fluid_->measure();
        set_gravity(Vec3(c.values[0], c.values[1], c.values[2]));
        report_.energy().jump(before, fluid_->measure());
      }
      if (coupled_) continue;  // the rigid process tells
      if (auto s = link_.command_result(step_, time_, c.id, ""); !s) return s;
    }
    commands_.clear();
    return ok();
  }

  void set_gravity(const Vec3& gravity) {
    scene_.world.gravity = gravity;
    fluid_->set_gravity(gravity);
    interface_.set_gravity(gravity);
    limits_ = step_limits(scene_, bodies_, *fluid_);
  }

  /// For checkpoints; the rigid process knows the bodies.
  template <class A>
  void state(A& a) {
    a("step", step_), a("time", time_), a("last_row", last_row_), a("last_row_time", last_row_time_);
    a("gravity", scene_.world.gravity), a("simd", simd_), a("fluid", *fluid_), a("report", report_);
    a("sleep", sleep_);
    if (coupled_)
      a("interface", interface_);
    else
      a("states", states_);
  }

  Status write_checkpoint() {
    checkpoint::StateWriter writer;
    state(writer);
    link_.beat();
    auto seal =
        checkpoint::write_part(checkpoint::folder_of(segment_.out_dir(), step_), checkpoint::kFluidPart, writer.take());
    if (!seal) return seal.error();
    return link_.checkpoint(step_, time_, {seal->bytes, seal->hash});
  }

  Status resume() {
    auto part = checkpoint::read_part(segment_.resume_dir(), checkpoint::kFluidPart);
    if (!part) return part.error();
    checkpoint::StateReader reader(*part);
    state(reader);
    if (auto s = reader.status(); !s) return s;
    // Reduced gravity is not the scene's, and cannot be changed.
    if (!scene_.numerics.reduced_gravity) set_gravity(scene_.world.gravity);
    if (step_ != segment_.first_step())
      return Error{
          fmt::format("the fluid's part of the checkpoint is of step {}, not {}", step_, segment_.first_step()),
          "resume from another checkpoint", segment_.resume_dir()};
    if (simd_ != simd_name())
      report_.warn(
          fmt::format("the checkpoint was written with {}, this processor uses {}: the continued run may differ "
                      "in the last bits",
                      simd_, simd_name()));
    simd_ = simd_name();
    due_ = checkpoint::Due(segment_.checkpoint_every(), time_);
    return ok();
  }

  /// The step itself; reads like the one in the folder's README.
  Status try_step(Step& step, std::uint32_t& iteration, double end) {
    interface_.begin(states_, step_ == 0 && fluid_->implicit());
    fluid_->begin(states_, step.dt, interface_.may_repeat());
    if (const double rate = fluid_->facts().drag_rate; rate * step.dt > kMostDrag) {
      // The last step could not know it: there was none, or a body has come into the fluid.
      fluid_->roll_back();
      step = {1 / rate, Limit::kViscosity};
      fluid_->begin(states_, step.dt, interface_.may_repeat());
    }
    states_before_ = states_;
    if (!coupled_) {
      fluid_->move();
      return ok();
    }
    Status sent = ok();
    const auto send_wrenches = [&] { sent = send(step.dt, iteration, 0, fluid_->contacts(), end); };
    if (interface_.may_repeat())
      send_wrenches();
    else
      fluid_->move(send_wrenches);  // while the rigid process works
    if (!sent) return sent;
    if (auto s = take_answer(iteration); !s) return s;
    while (!interface_.settle(fluid_->wrenches(), states_)) {
      repeat(step);
      if (auto s = send(step.dt, ++iteration, 0, fluid_->contacts(), end); !s) return s;
      if (auto s = take_answer(iteration); !s) return s;
    }
    if (interface_.may_repeat()) fluid_->move();
    return ok();
  }

  /// The wrenches for other free accelerations. In the first step these decide the pressure that the fluid starts with,
  /// too: without that the wave of bodies let go one by one hides what joined ones do.
  void repeat(const Step& step) {
    if (step_ > 0 || fluid_->implicit()) return fluid_->again(interface_.assumed());
    fluid_->roll_back();
    report_.quiet(fluid_->quiet_start(interface_.assumed()));
    fluid_->begin(interface_.assumed(), step.dt, true);
  }

  Status take_answer(std::uint32_t iteration) {
    auto answer = link_.receive(step_ + 1, iteration, states_);
    if (!answer) return answer.error();
    engine_bound_ = answer->max_dt > 0 ? answer->max_dt : 1e300;
    return ok();
  }

  Status rows(bool always) {
    if (auto s = report_.new_warnings(link_, step_, time_); !s) return s;
    const std::int64_t number = intervals_passed(time_, scene_.output.every);
    if ((!always && number <= last_row_) || time_ == last_row_time_) return ok();
    last_row_ = number;
    last_row_time_ = time_;
    if (auto s = report_.write_frame(states_, time_); !s) return s;
    if (monitor_) monitor_->offer(link_, step_, time_, last_limit_, report_.measured(), states_before_);
    const auto values = read_probes(scene_, *fluid_, states_);
    return values.empty() ? ok() : link_.frame(exchange::FrameKind::kProbes, step_, time_, values);
  }

  Status diverged(const Step& step) {
    const LastStep last{step_,
                        time_,
                        step.dt,
                        report_.worst_mach(),
                        report_.measured().compression_mean,
                        report_.energy().gain(),
                        report_.energy().share_now()};
    Error error = post_mortem(scene_, bodies_, *fluid_, states_, last);
    if (auto s = report_.write_post_mortem(states_, time_); !s) error.what += "; " + s.error().text();
    return error;
  }

  static constexpr std::uint32_t kRetries = 8;
  static constexpr double kMostDrag = 1.2;  // of the body's speed that viscosity may take in a step

  exchange::Segment& segment_;
  exchange::FluidLink link_;
  Scene scene_;
  std::vector<Body> bodies_;
  std::unique_ptr<WcsphFluid> fluid_;
  Report report_;
  exchange::Sleep sleep_;
  bool coupled_, stopped_ = false;
  Interface interface_;
  StepLimits limits_;
  Limit last_limit_ = Limit::kSound;
  std::unique_ptr<MonitorFrames> monitor_;
  std::vector<exchange::BodyState> states_, states_before_;
  std::vector<exchange::Command> commands_;
  double engine_bound_ = 1e300;
  std::uint64_t step_ = 0;
  double time_ = 0;
  std::int64_t last_row_ = -1;
  double last_row_time_ = -1;
  bool cut_ = false;  // a step was made shorter for the end: from a checkpoint after it no longer run could go on
  checkpoint::Due due_;
  std::string simd_ = simd_name();
};

}  // namespace

Status serve(exchange::Segment& segment) {
  const auto fail = [&](const Error& error) -> Status {
    exchange::FluidLink link(segment);
    if (auto s = link.finish(error.exit_code, failure_json(error)); !s) return s;
    return error;
  };
  auto scene = read_scene_text(std::string(segment.scene_text()), "scene");
  if (!scene) return fail(scene.error());
  auto bodies = make_bodies(*scene);
  if (!bodies) return fail(bodies.error());
  auto fluid = WcsphFluid::make(
      *scene, *bodies, static_cast<int>(segment.threads()),
      [link = std::make_shared<exchange::FluidLink>(segment)] { link->beat(); }, segment.resume_dir().empty());
  if (!fluid) return fail(fluid.error());
  Server server(segment, *std::move(scene), *std::move(bodies), *std::move(fluid));
  const Status outcome = server.run();
  if (auto s = server.finish(outcome); !s && outcome) return s;
  return outcome;
}

}  // namespace ballast::fluid
