// The fluid's part of the run record.
#include "fluid_server/report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/exchange/hash.h"
#include "common/exchange/sleep_json.h"
#include "common/output/picture.h"
#include "fluid_server/left_out.h"
#include "fluid_server/probes/probes.h"
#include "fluid_server/step/accuracy.h"

namespace ballast::fluid {

namespace {

nlohmann::json vector_json(const Vec3& v) { return {v[0], v[1], v[2]}; }

std::uint64_t resident_bytes() {
  unsigned long pages = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%lu %lu", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Particles as the writers want them.
struct Views {
  std::vector<float> position, velocity, pressure, density;
  explicit Views(const WcsphFluid& fluid) {
    const double c2 = static_cast<double>(fluid.constants().sound_speed) * fluid.constants().sound_speed;
    for (std::size_t f = 0; f < fluid.particles().size(); ++f) {
      const Record& r = fluid.particles().record[f];
      const Vec3 x = fluid.coordinates().to_metres(r.x, r.y, r.z);
      for (int k = 0; k < 3; ++k) position.push_back(static_cast<float>(x[k]));
      velocity.insert(velocity.end(), {r.vx, r.vy, r.vz});
      pressure.push_back(r.p);
      density.push_back(static_cast<float>(fluid.fluid_of(fluid.particles().id[f]).density + r.p / c2));
    }
  }
  output::ParticleFrame frame() const { return {position, velocity, pressure, density}; }
};

std::vector<Pose> poses_of(std::span<const exchange::BodyState> states) {
  std::vector<Pose> poses;
  for (const auto& s : states) poses.push_back({Vec3::Map(s.position), rotation_of(s)});
  return poses;
}

}  // namespace

Report::Report(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid, std::string out_dir)
    : scene_(scene),
      bodies_(bodies),
      fluid_(fluid),
      out_dir_(std::move(out_dir)),
      impulse_(bodies.size(), Vec3::Zero()),
      angular_impulse_(bodies.size(), Vec3::Zero()),
      energy_(scene, bodies, fluid) {
  start_ = last_ = fluid.measure();
  energy_.start(start_);
  if (scene.output.vtk) vtk_ = std::make_unique<output::VtkSeries>(out_dir_ + "/vtk");
  warn_of_thin_solids();
  std::vector<exchange::BodyState> states;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    states.push_back(initial_state(scene.models[b], bodies[b], scene.world.gravity));
  if (const std::size_t outside = count_misplaced(scene, bodies, fluid, states); outside > 0)
    warn(
        fmt::format("{} of {} particles start outside every container or inside a solid: they fall or flow away, and "
                    "count as lost where they leave the domain; shrink the fills, or make the container larger",
                    outside, fluid.particles().size()));
  const RelaxReport& relaxed = fluid.relax_report();
  if (!relaxed.settled)
    warn(fmt::format(
        "the start was not fully relaxed: after {} rounds particles still move by {:.2g} spacings a round, the "
        "spread of the summed density is {:.2g}",
        relaxed.moves, relaxed.last_move, relaxed.spread_after));
}

/// Particles on the two sides of a thin solid are within each other's support.
void Report::warn_of_thin_solids() {
  const Samples& samples = fluid_.samples();
  std::vector<double> deepest(bodies_.size(), 0.0);
  for (std::size_t s = 0; s < samples.size(); ++s)
    deepest[samples.body[s]] = std::max<double>(deepest[samples.body[s]], samples.depth[s]);
  const double least = fluid_.constants().kernel.support - fluid_.spacing();
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    if (deepest[b] > 0 && 2 * deepest[b] < least * (1 - 1e-6))
      warn(fmt::format(
          "'{}' is about {:.2g} m thick, less than {:.2g} m: the fluid on its one side feels that on the other; make "
          "it thicker or world.spacing smaller",
          scene_.models[b].name, 2 * deepest[b], least));
}

void Report::quiet(const QuietReport& quiet) {
  settled(quiet);
  start_ = last_ = fluid_.measure();
  energy_.start(start_);
}

void Report::settled(const QuietReport& quiet) {
  quiet_ = quiet;
  if (quiet.change > 1e-3)
    warn(fmt::format(
        "the starting pressure was not found to the end: after {} rounds it still changes by {:.2g} a round",
        quiet.rounds, quiet.change));
}

void Report::warn(std::string text) { warnings_.push_back(std::move(text)); }

void Report::count_impulses(double dt, std::span<const exchange::BodyState> states) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const exchange::Wrench& w = fluid_.wrenches()[b];
    const Vec3 impulse = Vec3::Map(w.force) * dt;
    angular_impulse_[b] += Vec3::Map(states[b].position).cross(impulse) + Vec3::Map(w.torque) * dt;
    if (scene_.models[b].motion == Motion::kStatic) continue;
    impulse_[b] += impulse;
    impulse_total_ += impulse;
    impulse_scale_ += impulse.norm();
  }
}

// Forces on bodies at rest go on; the density error is that of the steps computed.
void Report::count_slept(double dt, std::span<const exchange::BodyState> states) {
  ++limits_[static_cast<std::size_t>(Limit::kAsleep)];
  count_impulses(dt, states);
}

void Report::count(Limit limit, std::span<const exchange::BodyState> before, std::span<const exchange::BodyState> after,
                   double dt, double time) {
  ++limits_[static_cast<std::size_t>(limit)];
  if (const ImplicitPressure* implicit = fluid_.implicit();
      implicit && quiet_.rounds < implicit->report().release_rounds)
    settled({implicit->report().release_rounds, implicit->report().release_change});
  count_impulses(dt, before);
  energy_.step(before, after, dt);
  if (steps_since_measure_++ % 20 == 0) {
    last_ = fluid_.measure();
    count_energy(time);
    error_mean_sum_ += last_.compression_mean;
    error_max_ = std::max(error_max_, last_.compression_max);
    ++error_count_;
  }
  const double mach = fluid_.facts().max_speed / fluid_.constants().sound_speed;
  if (!fluid_.implicit() && mach > 0.3 && worst_mach_ <= 0.3)
    warn(fmt::format(
        "at t = {:.4g} s the fluid reached {:.2g} times the sound speed of {:.3g} m/s: densities are off by up to "
        "{:.0f} %; raise numerics.sound_speed",
        time, mach, fluid_.constants().sound_speed, 100 * mach * mach));
  worst_mach_ = std::max(worst_mach_, mach);
  if (fluid_.lost() > lost_seen_) {
    if (lost_seen_ == 0)
      warn(fmt::format("t = {:.4g} s: {}; further ones are only counted", time, fluid_.lost_where()));
    lost_seen_ = fluid_.lost();
  }
}

void Report::count_energy(double time) {
  const bool fine = energy_.share() <= kEnergyWarning;
  energy_.measure(last_);
  if (fine && energy_.share() > kEnergyWarning)
    warn(fmt::format(
        "at t = {:.4g} s the fluid had gained {:.3g} J that nobody gave it, {:.3g} % of the {:.3g} J at play: {}", time,
        energy_.gain(), 100 * energy_.share(), energy_.reference(),
        fluid_.implicit() ? "set world.accuracy: accurate, or make world.spacing smaller where bodies come off a wall"
                          : "lower numerics.courant, or make world.spacing smaller where bodies come off a wall"));
}

void Report::interface(Interface& interface, double time) {
  const std::uint64_t unreached = interface.report().unreached;
  interface.keep();
  interface_residual_ = interface.report().last;
  if (unreached == 0 && interface.report().unreached > 0)
    warn(
        fmt::format("t = {:.4g} s: fluid and bodies disagree by {:.2g} of the acceleration after {} iterations, "
                    "coupling.tolerance is "
                    "{:.2g}; further such steps are only counted",
                    time, interface_residual_, interface.most_iterations(), interface.tolerance()));
}

exchange::StepReport Report::step_report(std::uint64_t step, double time, const Step& dt, std::uint64_t hash) {
  exchange::StepReport r{};
  r.step = step;
  r.limit = static_cast<std::uint32_t>(dt.limit);
  r.time = time;
  r.dt = dt.dt;
  r.hash = hash;
  r.error[0] = last_.compression_mean;
  r.error[1] = last_.compression_max;
  if (const ImplicitPressure* implicit = fluid_.implicit()) r.error[2] = implicit->report().residual;
  r.error[3] = interface_residual_;
  r.particles = fluid_.particles().size();
  r.mass_drift = start_.mass > 0 ? last_.mass / start_.mass - 1 : 0.0;
  r.energy_gain = energy_.left_out().empty() ? energy_.share() : std::numeric_limits<double>::quiet_NaN();
  Vec3::Map(r.impulse) = impulse_total_;
  r.impulse_scale = impulse_scale_;
  return r;
}

Status Report::new_warnings(exchange::Link& link, std::uint64_t step, double time) {
  for (; warnings_sent_ < warnings_.size(); ++warnings_sent_)
    if (auto s = link.warning(step, time, warnings_[warnings_sent_]); !s) return s;
  return ok();
}

Status Report::write_frame(std::span<const exchange::BodyState> states, double time) {
  if (!vtk_) return ok();
  const auto poses = poses_of(states);
  return vtk_->add(time, Views(fluid_).frame(), bodies_, poses);
}

void Report::write_final(std::span<const exchange::BodyState> states, std::uint32_t threads) {
  if (!scene_.output.picture) return;
  const auto poses = poses_of(states);
  if (auto s = output::make_picture(out_dir_, scene_, bodies_, poses, Views(fluid_).frame(), static_cast<int>(threads));
      !s)
    warn(s.error().text());
}

Status Report::write_post_mortem(std::span<const exchange::BodyState> states, double time) const {
  return output::VtkSeries(out_dir_ + "/post_mortem").add(time, Views(fluid_).frame(), bodies_, poses_of(states));
}

std::string Report::json(std::uint64_t step, double time, bool stopped, std::span<const exchange::BodyState> states,
                         const exchange::Link& link, const Status& outcome, const exchange::Sleep& sleep,
                         const Interface& interface) const {
  using nlohmann::json;
  const Measures end = fluid_.measure();
  json j;
  const std::size_t misplaced = count_misplaced(scene_, bodies_, fluid_, states);
  std::vector<std::string> warnings = warnings_;
  if (misplaced + fluid_.lost() > 0)
    warnings.push_back(fmt::format(
        "{} particles ended outside every container or inside a solid, {} left the domain; see that fluids start "
        "inside, that containers are closed where water splashes, and try a smaller world.spacing",
        misplaced, fluid_.lost()));
  j["particles"] = {{"fluid", fluid_.particles().size()},
                    {"boundary", fluid_.samples().size()},
                    {"lost", fluid_.lost() + misplaced},
                    {"left_domain", fluid_.lost()},
                    {"misplaced", misplaced}};
  j["steps"] = step;
  j["simulated_s"] = time;
  j["stopped"] = stopped;
  for (std::size_t k = 0; k < limits_.size(); ++k)
    if (limits_[k]) j["step_limits"][kLimitNames[k]] = limits_[k];
  const StageTimes& t = fluid_.times();
  if (auto slept = exchange::sleep_json(sleep); !slept.is_null()) j["sleep"] = std::move(slept);
  j["stages"] = {{"sort", t.sort},
                 {"pressure", t.pressure},
                 {"boundary", t.boundary},
                 {"motion", t.motion},
                 {"wait", link.seconds_waited()}};
  j["error"] = {
      {"density_mean", error_count_ ? error_mean_sum_ / static_cast<double>(error_count_) : end.compression_mean},
      {"density_max", std::max(error_max_, end.compression_max)},
      {"pressure_residual", 0},
      {"interface_residual", 0},
      {"energy_gain", energy_.left_out().empty() ? json(energy_.share()) : json(nullptr)}};
  if (const InterfaceReport& r = interface.report(); r.steps > 0) {
    const double steps = static_cast<double>(r.steps);
    j["error"]["interface_residual"] = r.most;
    j["error"]["interface_residual_mean"] = r.sum / steps;
    if (interface.iterates())
      j["coupling"] = {{"tolerance", interface.tolerance()},
                       {"steps", r.steps},
                       {"iterations_mean", static_cast<double>(r.iterations) / steps},
                       {"iterations_most", r.most_iterations},
                       {"tolerance_unreached", r.unreached}};
  }
  j["ledger"] = {
      {"momentum_to_bodies_N_s", vector_json(impulse_total_)},
      {"momentum_scale", impulse_scale_},
      {"momentum_start", vector_json(start_.momentum)},
      {"momentum_end", vector_json(end.momentum)},
      {"angular_momentum_start_N_m_s", vector_json(start_.angular_momentum)},
      {"angular_momentum_end_N_m_s", vector_json(end.angular_momentum)},
      {"mass_kg", end.mass},
      {"mass_drift", start_.mass > 0 ? end.mass / start_.mass - 1 : 0.0},
      {"energy_J",
       {{"kinetic", end.kinetic},
        {"potential", end.potential},
        {"elastic", end.elastic},
        {"work_on_bodies", energy_.work()},
        {"gain", energy_.left_out().empty() ? json(energy_.gain()) : json(nullptr)},
        {"reference", energy_.reference()},
        {"change", end.kinetic + end.potential + end.elastic - start_.kinetic - start_.potential - start_.elastic}}}};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    j["ledger"]["angular_per_model_N_m_s"][scene_.models[b].name] = vector_json(angular_impulse_[b]);
    if (scene_.models[b].motion != Motion::kStatic)
      j["ledger"]["per_body_N_s"][scene_.models[b].name] = vector_json(impulse_[b]);
  }
  for (const FillReport& f : fluid_.filled().reports)
    j["fills"].push_back({{"fluid", f.fluid},
                          {"volume_asked_m3", f.volume_asked},
                          {"volume_got_m3", f.volume_got},
                          {"mass_asked_kg", f.mass_asked},
                          {"mass_kg", f.mass},
                          {"particles", f.particles}});
  j["left_out"] = left_out_rows(fluid_, scene_.numerics.skip_search, energy_.left_out(), interface,
                                step - std::min(step, sleep.steps()));
  const RelaxReport& relaxed = fluid_.relax_report();
  j["relaxation"] = {
      {"rounds", relaxed.moves}, {"spread_before", relaxed.spread_before}, {"spread_after", relaxed.spread_after}};
  j["quiet_start"] = {{"rounds", quiet_.rounds}, {"change", quiet_.change}};
  if (const ImplicitPressure* implicit = fluid_.implicit()) {
    const ImplicitReport& r = implicit->report();
    const double solves = static_cast<double>(std::max<std::uint64_t>(r.solves, 1));
    j["pressure_solve"] = {{"solves", r.solves},
                           {"products_mean", static_cast<double>(r.products) / solves},
                           {"products_most", r.most},
                           {"expansions_mean", static_cast<double>(r.expansions) / solves},
                           {"projected_steps_refused", r.refused},
                           {"tolerance_unreached", r.unreached},
                           {"residual_worst", r.worst_residual},
                           {"seconds", r.seconds}};
    j["error"]["pressure_residual"] = r.worst_residual;
  }
  if (const ShiftReport* shifting = fluid_.shifting())
    j["shifting"] = {
        {"mean_spacings", shifting->mean / static_cast<double>(std::max<std::uint64_t>(shifting->steps, 1))},
        {"largest_spacings", shifting->largest}};
  const BarrierReport& barrier = fluid_.barrier();
  j["barrier"] = {{"pushes", barrier.pushes},
                  {"impulse_N_s", barrier.impulse},
                  {"deepest_spacings", barrier.deepest / fluid_.spacing()}};
  j["solver"] = {{"pressure", fluid_.implicit() ? "implicit" : "wcsph"},
                 {"kernel", fluid_.constants().kernel.kind == KernelKind::kCubic ? "cubic spline" : "Wendland C2"},
                 {"support_m", fluid_.constants().kernel.support},
                 {"sound_speed", fluid_.constants().sound_speed},
                 {"simd", simd_name()}};
  j["scheme"] = interface.iterates() ? "iterated" : fluid_.scheme() == Scheme::kStaggered ? "staggered" : "interlinked";
  j["threads"] = fluid_.constants().threads;
  j["rss_bytes"] = resident_bytes();
  j["array_bytes"] = fluid_.memory();
  j["state_hash"] = fmt::format("{:016x}", fluid_.hash());
  j["warnings"] = warnings;
  if (link.dropped_frames() > 0) j["monitor_frames_dropped"] = link.dropped_frames();
  if (!outcome) j["failure"] = outcome.error().text();
  return j.dump();
}

namespace {

/// The staggered scheme hands a body's last acceleration to its surface, so that the water that a step reaches swings
/// with the body: dt <= (d / c) sqrt(2 sigma / (rho d)), sigma = mass over wetted area (chain of particles that ends in
/// a light mass).
double staggered_bound(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid) {
  std::vector<double> area(bodies.size(), 0.0);
  const Samples& samples = fluid.samples();
  const double d = fluid.spacing();
  for (std::size_t s = 0; s < samples.size(); ++s)  // only the first layer, half a pitch inside, stands for surface
    if (samples.depth[s] < 0.75 * d) area[samples.body[s]] += samples.volume[s] / (2 * samples.depth[s]);
  double density = 0, bound = 1e300;
  for (const Fluid& f : scene.fluids) density = std::max(density, f.density);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].mass > 0 && area[b] > 0)
      bound =
          std::min(bound, d / fluid.constants().sound_speed * std::sqrt(2 * bodies[b].mass / (area[b] * density * d)));
  return bound;
}

}  // namespace

StepLimits step_limits(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid) {
  StepLimits limits;
  limits.h = fluid.constants().kernel.h();
  limits.sound_speed = fluid.constants().sound_speed;
  // Still water, a floating box and a dam break come out the same from 0.25 to 0.8 (README.md); a chain of particles
  // becomes unstable at d / c, which is 1 for the cubic spline.
  limits.courant = settings_of(scene.world.accuracy).courant;
  if (fluid.implicit()) {
    limits.implicit = true;
    limits.spacing = fluid.spacing();
    limits.gravity_step = gravity_step(scene);
    const double move = settings_of(scene.world.accuracy).longest_move;
    limits.longest_move = fluid.shifting() ? kLongestShiftedMove : move;
    limits.most_move = kBeyondForetold * move;
  }
  if (scene.numerics.courant > 0) limits.courant = scene.numerics.courant;
  if (fluid.scheme() == Scheme::kStaggered) limits.staggered = staggered_bound(scene, bodies, fluid);
  for (const Fluid& f : scene.fluids)
    limits.kinematic_viscosity = std::max(limits.kinematic_viscosity, f.viscosity / f.density);
  return limits;
}

std::string failure_json(const Error& error) { return nlohmann::json{{"failure", error.text()}}.dump(); }

}  // namespace ballast::fluid
