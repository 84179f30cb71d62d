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

/// Sums, largest and smallest values: add(i, part) adds entry i to the Part of its block, other.add of Part joins two.
template <class Part, class Add>
Part fold(std::size_t n, int threads, Add&& add) {
  std::vector<Part> part((n + kSumBlock - 1) / kSumBlock);
  for_blocks(n, threads, [&](std::size_t begin, std::size_t end) {
    Part own{};
    for (std::size_t i = begin; i < end; ++i) add(i, own);
    part[begin / kSumBlock] = own;
  });
  Part all{};
  for (const Part& one : part) all.add(one);
  return all;
}

/// Sums of K quantities: add(i, sum) adds those of entry i to an array of K.
template <std::size_t K, class Add>
std::array<double, K> sum_of(std::size_t n, int threads, Add&& add) {
  struct Sums {
    std::array<double, K> of{};
    void add(const Sums& other) {
      for (std::size_t k = 0; k < K; ++k) of[k] += other.of[k];
    }
  };
  return fold<Sums>(n, threads, [&](std::size_t i, Sums& part) { add(i, part.of); }).of;
}

}  // namespace ballast::fluid
