// Loops and sums over long arrays whose results do not depend on the number of threads.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace ballast::fluid {

inline constexpr std::size_t kSumBlock = 1024;  // entries per partial sum: fixed, so that sums do not depend on threads
inline constexpr std::size_t kSerial = 16384;   // below this a second thread costs more than it brings

/// Calls task(begin, end) for blocks that cover 0 .. n.
template <class Task>
void for_blocks(std::size_t n, int threads, Task&& task) {
  const std::size_t blocks = (n + kSumBlock - 1) / kSumBlock;
#pragma omp parallel for num_threads(threads) schedule(static) if (n > kSerial)
  for (std::size_t b = 0; b < blocks; ++b) task(b * kSumBlock, std::min(n, (b + 1) * kSumBlock));
}

/// Sums of K quantities: task(begin, end) returns those of a block.
template <std::size_t K, class Task>
std::array<double, K> sum_blocks(std::size_t n, int threads, Task&& task) {
  const std::size_t blocks = (n + kSumBlock - 1) / kSumBlock;
  std::vector<std::array<double, K>> part(blocks);
#pragma omp parallel for num_threads(threads) schedule(static) if (n > kSerial)
  for (std::size_t b = 0; b < blocks; ++b) part[b] = task(b * kSumBlock, std::min(n, (b + 1) * kSumBlock));
  std::array<double, K> sum{};
  for (const auto& one : part)
    for (std::size_t k = 0; k < K; ++k) sum[k] += one[k];
  return sum;
}

}  // namespace ballast::fluid
