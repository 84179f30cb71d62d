// The k-th largest of many numbers.
#include "fluid_server/step/larger_than.h"

#include <array>
#include <bit>
#include <cstdint>

#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

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

}  // namespace ballast::fluid
