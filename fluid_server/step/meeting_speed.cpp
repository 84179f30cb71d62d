// How fast particles meet what is around them.
#include "fluid_server/step/meeting_speed.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "fluid_server/pressure/sums.h"

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

/// The one of some numbers >= 0 that k are larger than, by counting their bits (which order like they do) eleven at a
/// time: all threads count, and the result does not depend on their number.
float larger_than_all_but(std::size_t k, std::span<const float> numbers, int threads) {
  constexpr std::uint32_t kBins = 1 << 11;
  std::uint32_t found = 0, known = 0;
  for (const int shift : {21, 10, 0}) {
    const std::uint32_t digit = shift > 0 ? kBins - 1 : kBins / 2 - 1;
    std::array<std::size_t, kBins> count{};
#pragma omp parallel num_threads(threads) if (numbers.size() > kSerial)
    {
      std::array<std::size_t, kBins> own{};
#pragma omp for schedule(static) nowait
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto bits = std::bit_cast<std::uint32_t>(numbers[i]);
        if ((bits & known) == found) ++own[bits >> shift & digit];
      }
#pragma omp critical
      for (std::size_t bin = 0; bin < kBins; ++bin) count[bin] += own[bin];
    }
    std::uint32_t bin = digit;
    for (; count[bin] <= k; --bin) k -= count[bin];
    found |= bin << shift, known |= digit << shift;
  }
  return std::bit_cast<float>(found);
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
