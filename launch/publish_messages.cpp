// Records to messages, field by field.
#include "launch/publish_messages.h"

#include <algorithm>
#include <limits>

#include "common/output/columns.h"

namespace ballast::launch {

using exchange::Frame;

namespace {

/// Cuts a list into chunks; an empty list is one empty chunk, so that monitors see that there is nothing.
template <class Message, class Add>
std::vector<Message> in_chunks(const Frame& frame, std::int64_t number, std::size_t size, std::size_t most, Add&& add) {
  const std::size_t chunks = std::max<std::size_t>(1, (size + most - 1) / most);
  std::vector<Message> out(chunks);
  for (std::size_t c = 0; c < chunks; ++c) {
    Message& m = out[c];
    m.time = frame.head.time;
    m.step = static_cast<std::int64_t>(frame.head.step);
    m.frame = number;
    m.chunk = static_cast<std::int32_t>(c);
    m.chunks = static_cast<std::int32_t>(chunks);
    const std::size_t first = c * most, end = std::min(size, first + most);
    m.count = static_cast<std::int32_t>(end - first);
    for (std::size_t i = first; i < end; ++i) add(m, i);
  }
  return out;
}

std::size_t rows_of(const MessageFacts& facts, const Frame& frame) {
  return std::min(facts.moving.size(), frame.values().size() / output::kBodyValues);
}

}  // namespace

MessageFacts MessageFacts::of(const Prepared& prepared) {
  MessageFacts facts{prepared.scene.name, prepared.scene.world.duration, prepared.fluid, {}, {}};
  for (const Model& model : prepared.scene.models) facts.bodies.push_back(model.name);
  for (int i : output::moving_models(prepared.scene)) facts.moving.push_back(facts.bodies[static_cast<std::size_t>(i)]);
  return facts;
}

double RealTimeFactor::update(double time, double wall) {
  if (wall - now_.wall > 1) before_ = std::exchange(now_, {time, wall});
  return wall > before_.wall ? (time - before_.time) / (wall - before_.wall) : 0;
}

std::vector<body_states_t> body_messages(const MessageFacts& facts, const Frame& frame, std::int64_t number) {
  const auto values = frame.values();
  return in_chunks<body_states_t>(frame, number, rows_of(facts, frame), kListChunk,
                                  [&](body_states_t& m, std::size_t i) {
                                    const double* v = values.data() + i * output::kBodyValues;
                                    body_state_t& b = m.bodies.emplace_back();
                                    b.name = facts.moving[i];
                                    std::copy_n(v, 3, b.position);
                                    std::copy_n(v + 3, 4, b.orientation);
                                    std::copy_n(v + 7, 3, b.velocity);
                                    std::copy_n(v + 10, 3, b.angular_velocity);
                                    std::copy_n(v + 13, 3, b.acceleration);
                                  });
}

std::vector<wrenches_t> wrench_messages(const MessageFacts& facts, const Frame& frame, std::int64_t number) {
  const auto values = frame.values();
  return in_chunks<wrenches_t>(frame, number, rows_of(facts, frame), kListChunk, [&](wrenches_t& m, std::size_t i) {
    const double* v = values.data() + i * output::kBodyValues;
    wrench_t& w = m.wrenches.emplace_back();
    w.body = facts.moving[i];
    std::copy_n(v + 16, 3, w.force);
    std::copy_n(v + 19, 3, w.torque);
  });
}

std::vector<contact_sets_t> contact_messages(const MessageFacts& facts, const Frame& frame, std::int64_t number) {
  const std::vector<exchange::Contact> contacts = frame.contacts();
  return in_chunks<contact_sets_t>(frame, number, contacts.size(), kListChunk, [&](contact_sets_t& m, std::size_t i) {
    const exchange::Contact& from = contacts[i];
    contact_t& c = m.contacts.emplace_back();
    c.body = from.body < facts.bodies.size() ? facts.bodies[from.body] : "?";
    c.samples = static_cast<std::int32_t>(from.samples);
    std::copy_n(from.position, 3, c.position);
    std::copy_n(from.normal, 3, c.normal);
    std::copy_n(from.force, 3, c.force);
    c.depth = from.depth;
    c.area = from.area;
  });
}

std::vector<particles_t> particle_messages(const Frame& frame, std::int64_t number) {
  const exchange::ParticleSetHead head = frame.particle_head();
  const std::vector<exchange::ParticleSample> samples = frame.particles();
  auto out = in_chunks<particles_t>(frame, number, samples.size(), kParticleChunk, [&](particles_t& m, std::size_t i) {
    const exchange::ParticleSample& s = samples[i];
    m.id.push_back(static_cast<std::int32_t>(s.id));
    m.x.push_back(s.position[0]);
    m.y.push_back(s.position[1]);
    m.z.push_back(s.position[2]);
    m.vx.push_back(s.velocity[0]);
    m.vy.push_back(s.velocity[1]);
    m.vz.push_back(s.velocity[2]);
    m.pressure.push_back(s.pressure);
  });
  for (particles_t& m : out) {
    m.particles = static_cast<std::int64_t>(head.particles);
    m.every = static_cast<std::int32_t>(head.every);
    m.shown = static_cast<std::int32_t>(samples.size());
  }
  return out;
}

fluid_statistics_t fluid_message(const Frame& frame) {
  const exchange::FluidStatistics s = frame.fluid();
  fluid_statistics_t m;
  m.time = frame.head.time;
  m.step = static_cast<std::int64_t>(frame.head.step);
  m.particles = static_cast<std::int64_t>(s.particles);
  m.lost = static_cast<std::int64_t>(s.lost);
  m.mass = s.mass;
  m.kinetic = s.kinetic;
  m.potential = s.potential;
  m.elastic = s.elastic;
  std::copy_n(s.momentum, 3, m.momentum);
  m.density_error_mean = s.error_mean;
  m.density_error_max = s.error_max;
  m.max_speed = s.max_speed;
  m.sound_speed = s.sound_speed;
  m.step_limit = s.limit;
  m.sort_time = s.sort;
  m.pressure_time = s.pressure;
  m.boundary_time = s.boundary;
  m.motion_time = s.motion;
  m.wait_time = s.wait;
  m.dropped = static_cast<std::int64_t>(s.dropped);
  return m;
}

warning_t warning_message(exchange::Role role, const Frame& frame) {
  warning_t m;
  m.time = frame.head.time;
  m.step = static_cast<std::int64_t>(frame.head.step);
  m.process = exchange::role_name(role);
  m.text = frame.text();
  return m;
}

status_t status_message(const MessageFacts& facts, const RunStatus& s, const std::string& limit,
                        RealTimeFactor& speed) {
  status_t m;
  m.run = s.run;
  m.scene = facts.scene;
  m.state = s.state;
  m.time = s.last.time;
  m.duration = facts.duration;
  m.step = static_cast<std::int64_t>(s.steps);
  m.dt = s.last.dt;
  m.step_limit = facts.fluid ? limit : "coupling.rigid_step";
  m.wall = s.wall;
  m.real_time_factor = speed.update(s.last.time, s.wall);
  m.real_time_factor_mean = s.wall > 0 && s.steps > 0 ? (s.last.time - s.first_time) / s.wall : 0;
  constexpr double no_figure = std::numeric_limits<double>::quiet_NaN();
  m.density_error_mean = s.errors.density_mean.value_or(0);
  m.density_error_max = s.errors.density_max.value_or(0);
  m.pressure_residual = s.errors.pressure.value_or(0);
  m.interface_residual = s.errors.interface.value_or(0);
  m.mass_drift = s.errors.mass.value_or(no_figure);
  m.momentum_imbalance = s.errors.momentum.value_or(no_figure);
  m.energy_gain = s.errors.energy.value_or(no_figure);
  m.particles = static_cast<std::int64_t>(s.last.particles);
  m.bodies = static_cast<std::int32_t>(facts.moving.size());
  m.fluid_pid = s.fluid.pid;
  m.rigid_pid = s.rigid.pid;
  m.fluid_state = s.fluid.state;
  m.rigid_state = s.rigid.state;
  m.fluid_compute = s.fluid.compute;
  m.fluid_wait = s.fluid.wait;
  m.rigid_compute = s.rigid.compute;
  m.rigid_wait = s.rigid.wait;
  m.warnings = static_cast<std::int32_t>(s.warnings);
  m.obeys = s.obeys;
  m.exit_code = s.exit_code;
  return m;
}

}  // namespace ballast::launch
