// The particles: one 32-byte record each, as the passes over pairs read it, in the order of the cells they lie in.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ballast::fluid {

/// What a neighbour needs to know of a particle or a boundary sample.
struct Record {
  std::uint32_t x, y, z;  ///< position, quanta of Coordinates
  float p;                ///< pressure, Pa
  float vx, vy, vz;       ///< velocity, m/s
  float volume;           ///< rest volume, m^3 (m^2 times 1 m in dimension 2); negative: a boundary sample's
};
static_assert(sizeof(Record) == 32, "two quarters of a cache line: the pair passes load it as two vectors of four");

/// All particles of all fluids, sorted by cell.
struct Particles {
  std::vector<Record> record;
  std::vector<std::uint32_t> id;   ///< unchanging name of the particle: its place in the initial fill
  std::vector<float> compression;  ///< implicit solver only: density over rest density - 1; else empty
  bool has_compression = false;
  std::size_t size() const { return record.size(); }
  /// One line per field: sorting, saving, hashing and snapshots follow from it; its name in state().
  template <class Visit>
  void for_each_field(Visit&& visit) const {
    visit(&Particles::record);
    visit(&Particles::id);
    if (has_compression) visit(&Particles::compression);
  }
  /// For checkpoints: in the order of the particles, which decides the order of sums.
  template <class A>
  void state(A& a) {
    a("record", record), a("id", id);
    if (has_compression) a("compression", compression);
  }
  bool at_rest() const {
    return std::all_of(record.begin(), record.end(),
                       [](const Record& r) { return r.vx == 0 && r.vy == 0 && r.vz == 0; });
  }
  void resize(std::size_t n) {
    for_each_field([&](auto field) { (this->*field).resize(n); });
  }
};

/// What all particles of one fluid have in common; particles belong to the fluid in whose range of ids they are.
struct FluidProperties {
  float density = 1000;  ///< rest density, kg/m^3
  float viscosity = 0;   ///< Pa s
  float volume = 0;      ///< of one particle, m^3
  std::uint32_t first_id = 0, count = 0;
};

}  // namespace ballast::fluid
