// Shares of a loop for threads: contiguous and of equal cost. Items lie in the order of their cells, so a thread that
// has the same share in every loop works on what lies together, and finds it in its cache.
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ballast::fluid {

/// Begins of the shares of 0 .. n, and the end: threads + 1 entries. cost(k) >= 0.
template <class Cost>
std::vector<std::uint32_t> shares_of(std::uint32_t n, int threads, Cost&& cost) {
  constexpr std::uint32_t kGrain = 64;  // shares begin at multiples of this
  const std::uint32_t grains = (n + kGrain - 1) / kGrain;
  std::vector<double> before(grains + 1, 0.0);
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::uint32_t g = 0; g < grains; ++g)
    for (std::uint32_t k = g * kGrain; k < std::min(n, (g + 1) * kGrain); ++k) before[g + 1] += cost(k);
  for (std::uint32_t g = 0; g < grains; ++g) before[g + 1] += before[g];
  std::vector<std::uint32_t> begin(static_cast<std::size_t>(threads) + 1, n);
  for (std::size_t t = 0; t + 1 < begin.size(); ++t) {
    const double target = before.back() * static_cast<double>(t) / threads;
    const auto at = std::lower_bound(before.begin(), before.end(), target) - before.begin();
    begin[t] = std::min(n, static_cast<std::uint32_t>(at) * kGrain);
  }
  return begin;
}

/// task(k) for k = 0 .. n, each by the next thread that is free: for tasks of unequal cost. Not schedule(dynamic):
/// Debian builds LLVM's runtime with its debugging texts, some ten of which it formats in every such loop.
template <class Task>
void for_each_by_turns(std::size_t n, int threads, Task&& task) {
  std::atomic<std::size_t> next{0};
#pragma omp parallel num_threads(threads) if (n > 1)
  for (std::size_t k = next.fetch_add(1, std::memory_order_relaxed); k < n;
       k = next.fetch_add(1, std::memory_order_relaxed))
    task(k);
}

/// task(k) for all k of all shares.
template <class Task>
void for_each_in(const std::vector<std::uint32_t>& shares, int threads, Task&& task) {
#pragma omp parallel for num_threads(threads) schedule(static, 1)
  for (std::size_t s = 0; s < shares.size() - 1; ++s)
    for (std::uint32_t k = shares[s]; k < shares[s + 1]; ++k) task(k);
}

}  // namespace ballast::fluid
