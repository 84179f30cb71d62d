// Loops and sums over long arrays whose results do not depend on the number of threads.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace ballast::fluid {

inline constexpr std::size_t kSumBlock = 1024;  // entries per partial sum: fixed, so that sums do not depend on threads
inline constexpr std::size_t kSerial = 2048;    // below this a second thread costs more than it brings

/// Calls task(begin, end) for blocks that cover 0 .. n.
template <class Task>
void for_blocks(std::size_t n, int threads, Task&& task) {
  const std::size_t blocks = (n + kSumBlock - 1) / kSumBlock;
#pragma omp parallel for num_threads(threads) schedule(static) if (n > kSerial)
  for (std::size_t b = 0; b < blocks; ++b) task(b * kSumBlock, std::min(n, (b + 1) * kSumBlock));
}

/// Sums, largest and smallest values: task(begin, end) returns those of a block, add(other) of Part joins two of them.
template <class Part, class Task>
Part fold_blocks(std::size_t n, int threads, Task&& task) {
  const std::size_t blocks = (n + kSumBlock - 1) / kSumBlock;
  std::vector<Part> part(blocks);
#pragma omp parallel for num_threads(threads) schedule(static) if (n > kSerial)
  for (std::size_t b = 0; b < blocks; ++b) part[b] = task(b * kSumBlock, std::min(n, (b + 1) * kSumBlock));
  Part all{};
  for (const Part& one : part) all.add(one);
  return all;
}

template <std::size_t K>
struct Sums {
  std::array<double, K> of{};
  void add(const Sums& other) {
    for (std::size_t k = 0; k < K; ++k) of[k] += other.of[k];
  }
};

/// Sums of K quantities: task(begin, end) returns those of a block.
template <std::size_t K, class Task>
std::array<double, K> sum_blocks(std::size_t n, int threads, Task&& task) {
  return fold_blocks<Sums<K>>(n, threads, [&](std::size_t begin, std::size_t end) { return Sums<K>{task(begin, end)}; })
      .of;
}

}  // namespace ballast::fluid
