// How fast particles meet what is around them.
#include "fluid_server/step/meeting_speed.h"

#include <algorithm>
#include <cmath>

#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

constexpr std::size_t kAtLeast = 64, kShare = 100;  // of all, one in kShare is looked at, and at least kAtLeast

struct Fast {
  float speed2;
  std::uint32_t particle;
};

float square(const Record& a, const Record& b) {
  const float x = a.vx - b.vx, y = a.vy - b.vy, z = a.vz - b.vz;
  return x * x + y * y + z * z;
}

}  // namespace

double meeting_speed(const Particles& particles, const Neighbourhood& items, double alone, int threads) {
  std::vector<Fast> fast(particles.size());
  for_blocks(fast.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      fast[f] = {square(particles.record[f], Record{}), static_cast<std::uint32_t>(f)};
  });
  const std::size_t looked_at = std::min(fast.size(), std::max(kAtLeast, fast.size() / kShare));
  const auto faster = [](const Fast& a, const Fast& b) { return a.speed2 > b.speed2; };
  float most2 = 0;
  if (looked_at < fast.size()) {
    std::nth_element(fast.begin(), fast.begin() + static_cast<std::ptrdiff_t>(looked_at), fast.end(), faster);
    most2 = fast[looked_at].speed2;
  }
  const float alone2 = static_cast<float>(alone * alone);
  for (std::size_t k = 0; k < looked_at; ++k) {
    const Record& own = particles.record[fast[k].particle];
    const std::uint32_t item = items.fluid_item[fast[k].particle];
    const std::uint32_t* list = items.lists.of(item);
    most2 = std::max(most2, alone2 * fast[k].speed2);
    for (std::uint32_t n = 0; n < items.lists.count[item]; ++n) {
      const std::uint32_t source = items.source[list[n]];
      most2 = std::max(most2,
                       square(own, source & Neighbourhood::kSample ? items.record[list[n]] : particles.record[source]));
    }
  }
  return std::sqrt(most2);
}

}  // namespace ballast::fluid
