// Frames as the coordinator takes them out of the rings, for tests of what becomes of them.
#pragma once
#include <cstring>

#include "launch/publish.h"

namespace ballast::monitor::testing {

using exchange::Frame;
using exchange::FrameKind;

template <class Record>
void append(Frame& frame, const Record& record) {
  const std::size_t end = frame.payload.size();
  frame.payload.resize(end + sizeof record);
  std::memcpy(frame.payload.data() + end, &record, sizeof record);
  frame.head.bytes = static_cast<std::uint32_t>(frame.payload.size());
}

inline Frame frame_of(FrameKind kind, std::uint64_t step = 7, double time = 0.25) {
  return {{kind, 0, step, time}, {}};
}

/// A row of `bodies` bodies: value k of body b is 100 b + k.
inline Frame bodies_frame(std::size_t bodies) {
  Frame frame = frame_of(FrameKind::kBodies);
  for (std::size_t b = 0; b < bodies; ++b) {
    for (std::size_t k = 0; k < 22; ++k) append(frame, static_cast<double>(100 * b + k));
  }
  return frame;
}

/// `count` particles of 10 * count: id 10 i, at (i, -i, 0.5), moving with (1, 2, 3), pressure i.
inline Frame particles_frame(std::uint32_t count) {
  Frame frame = frame_of(FrameKind::kParticles);
  append(frame, exchange::ParticleSetHead{10ull * count, 10, count});
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(i);
    append(frame, exchange::ParticleSample{10 * i, {x, -x, 0.5f}, {1, 2, 3}, x});
  }
  return frame;
}

inline Frame contacts_frame(std::size_t count) {
  Frame frame = frame_of(FrameKind::kContacts);
  for (std::size_t i = 0; i < count; ++i) {
    exchange::Contact c{};
    c.body = 1;
    c.depth = static_cast<double>(i);
    append(frame, c);
  }
  return frame;
}

inline Frame warning_frame(const std::string& text) {
  Frame frame = frame_of(FrameKind::kWarning);
  for (char c : text) append(frame, c);
  return frame;
}

inline Frame fluid_frame() {
  Frame frame = frame_of(FrameKind::kFluid);
  exchange::FluidStatistics s{};
  s.mass = 240;
  s.particles = 3750;
  s.pressure = 3;
  s.wait = 1;
  std::strcpy(s.limit, "sound");
  append(frame, s);
  return frame;
}

/// A ball that falls, and a tank, in water; enough of a scene for names.
inline launch::Prepared prepared_scene() {
  auto scene = read_scene_text(
      "ballast: 1\nworld: { duration: 2 s, spacing: 0.1 }\n"
      "fluids: [ { name: water, material: water, fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } } } ]\n"
      "models:\n  - { name: tank, static: true, shape: { box: [1, 1, 1] }, pose: [5, 5, 5] }\n"
      "  - { name: ball, shape: { sphere: { radius: 0.1 } }, density: 500, pose: [0.5, 0.5, 0.9] }\n",
      "drop.yaml");
  auto bodies = make_bodies(*scene);
  return {std::move(*scene), std::move(*bodies), true, true, {}};
}

}  // namespace ballast::monitor::testing
