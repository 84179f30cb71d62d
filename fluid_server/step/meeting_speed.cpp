// How fast particles meet what is around them.
#include "fluid_server/step/meeting_speed.h"

#include <algorithm>
#include <cmath>

#include "fluid_server/pressure/sums.h"
#include "fluid_server/step/larger_than.h"

namespace ballast::fluid {

namespace {

constexpr std::size_t kAtLeast = 64, kShare = 100;  // of all, one in kShare is looked at, and at least kAtLeast

struct Fastest {
  float speed2 = 0;
  void add(const Fastest& other) { speed2 = std::max(speed2, other.speed2); }
};

float square(const Record& a, const Record& b) {
  const float x = a.vx - b.vx, y = a.vy - b.vy, z = a.vz - b.vz;
  return x * x + y * y + z * z;
}

}  // namespace

double meeting_speed(const Particles& particles, const Neighbourhood& items, double alone, int threads) {
  const std::size_t n = particles.size();
  std::vector<float> speed2(n);
  for_blocks(n, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) speed2[f] = square(particles.record[f], Record{});
  });
  const std::size_t looked_at = std::max(kAtLeast, n / kShare);
  const float others = looked_at < n ? larger_than_all_but(looked_at, speed2, threads) : -1;
  const float alone2 = static_cast<float>(alone * alone);
  const Fastest met = fold<Fastest>(n, threads, [&](std::size_t f, Fastest& part) {
    if (!(speed2[f] > others)) return;
    const Record& own = particles.record[f];
    const std::uint32_t item = items.fluid_item[f];
    const std::uint32_t* list = items.lists.of(item);
    part.add({alone2 * speed2[f]});
    for (std::uint32_t k = 0; k < items.lists.count[item]; ++k) {
      const std::uint32_t source = items.source[list[k]];
      part.add({square(own, source & Neighbourhood::kSample ? items.record[list[k]] : particles.record[source])});
    }
  });
  return std::sqrt(std::max(met.speed2, others));
}

}  // namespace ballast::fluid
