// Frames for monitors, made from what the step has computed anyway.
#include "fluid_server/monitor_frames.h"

#include <cstring>

namespace ballast::fluid {

using exchange::FrameKind;

bool MonitorFrames::wanted(const exchange::Segment& segment) {
  return segment.wants(FrameKind::kFluid) || segment.wants(FrameKind::kContacts) ||
         segment.wants(FrameKind::kParticles);
}

MonitorFrames::MonitorFrames(const exchange::Segment& segment, const Scene& scene, WcsphFluid& fluid)
    : fluid_(fluid),
      contacts_(segment.wants(FrameKind::kContacts)),
      most_particles_(segment.wants(FrameKind::kParticles) ? static_cast<std::size_t>(scene.output.lcm_particles) : 0) {
}

void MonitorFrames::offer(exchange::Link& link, std::uint64_t step, double time, Limit limit, const Measures& measures,
                          std::span<const exchange::BodyState> before) {
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(50);
  offer_statistics(link, step, time, limit, measures);
  if (contacts_) {
    const auto contacts = before.empty() ? std::span<const exchange::Contact>{} : fluid_.gather_contacts(before);
    link.offer(FrameKind::kContacts, step, time, std::as_bytes(contacts));
  }
  if (most_particles_ > 0) offer_particles(link, step, time);
}

void MonitorFrames::offer_statistics(exchange::Link& link, std::uint64_t step, double time, Limit limit,
                                     const Measures& measures) {
  exchange::FluidStatistics s{};
  s.mass = measures.mass;
  s.kinetic = measures.kinetic;
  s.potential = measures.potential;
  s.elastic = measures.elastic;
  for (int k = 0; k < 3; ++k) s.momentum[k] = measures.momentum[k];
  s.error_mean = measures.compression_mean;
  s.error_max = measures.compression_max;
  s.max_speed = fluid_.facts().max_speed;
  s.sound_speed = fluid_.constants().sound_speed;
  const StageTimes& t = fluid_.times();
  s.sort = t.sort;
  s.pressure = t.pressure;
  s.boundary = t.boundary;
  s.motion = t.motion;
  s.wait = link.seconds_waited();
  s.particles = fluid_.particles().size();
  s.lost = fluid_.lost();
  s.dropped = link.dropped_frames();
  std::strncpy(s.limit, kLimitNames[static_cast<std::size_t>(limit)], sizeof s.limit - 1);
  link.offer(FrameKind::kFluid, step, time, std::as_bytes(std::span(&s, 1)));
}

void MonitorFrames::offer_particles(exchange::Link& link, std::uint64_t step, double time) {
  const Particles& all = fluid_.particles();
  // By id, not by place: the same particles from frame to frame, so that their tracks can be drawn.
  const auto every =
      static_cast<std::uint32_t>(std::max<std::size_t>(1, (all.size() + most_particles_ - 1) / most_particles_));
  exchange::ParticleSetHead head{all.size(), every, 0};
  buffer_.resize(sizeof head);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all.id[i] % every != 0) continue;
    const Record& r = all.record[i];
    const Vec3 x = fluid_.coordinates().to_metres(r.x, r.y, r.z);
    const exchange::ParticleSample sample{
        all.id[i],
        {static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])},
        {r.vx, r.vy, r.vz},
        r.p};
    const auto bytes = std::as_bytes(std::span(&sample, 1));
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    ++head.count;
  }
  std::memcpy(buffer_.data(), &head, sizeof head);
  link.offer(FrameKind::kParticles, step, time, buffer_);
}

}  // namespace ballast::fluid
