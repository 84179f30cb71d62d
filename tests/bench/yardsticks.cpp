// Compiled once per instruction set, like the passes of the fluid, so that the yardstick has the same vectors.
#include "tests/bench/yardsticks.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/yardsticks.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace ballast::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Twelve chains hide the latency of four cycles on two units. Returns the flops done; `out` keeps the compiler honest.
double MultiplyAdd(std::size_t rounds, float* out) {
  const hn::ScalableTag<float> d;
  const auto a = hn::Set(d, 0.999f), b = hn::Set(d, 1e-3f);
  auto c0 = hn::Set(d, out[0]), c1 = hn::Add(c0, b), c2 = hn::Add(c1, b), c3 = hn::Add(c2, b), c4 = hn::Add(c3, b),
       c5 = hn::Add(c4, b), c6 = hn::Add(c5, b), c7 = hn::Add(c6, b), c8 = hn::Add(c7, b), c9 = hn::Add(c8, b),
       c10 = hn::Add(c9, b), c11 = hn::Add(c10, b);
  for (std::size_t i = 0; i < rounds; ++i) {
    c0 = hn::MulAdd(c0, a, b), c1 = hn::MulAdd(c1, a, b), c2 = hn::MulAdd(c2, a, b), c3 = hn::MulAdd(c3, a, b);
    c4 = hn::MulAdd(c4, a, b), c5 = hn::MulAdd(c5, a, b), c6 = hn::MulAdd(c6, a, b), c7 = hn::MulAdd(c7, a, b);
    c8 = hn::MulAdd(c8, a, b), c9 = hn::MulAdd(c9, a, b), c10 = hn::MulAdd(c10, a, b), c11 = hn::MulAdd(c11, a, b);
  }
  const auto low = hn::Add(hn::Add(hn::Add(c0, c1), hn::Add(c2, c3)), hn::Add(c4, c5));
  const auto high = hn::Add(hn::Add(hn::Add(c6, c7), hn::Add(c8, c9)), hn::Add(c10, c11));
  out[0] = hn::GetLane(hn::SumOfLanes(d, hn::Add(low, high)));
  return 2.0 * 12.0 * static_cast<double>(hn::Lanes(d)) * static_cast<double>(rounds);
}

}  // namespace HWY_NAMESPACE
}  // namespace ballast::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballast::bench {

HWY_EXPORT(MultiplyAdd);

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

volatile float sink;

}  // namespace

double fma_peak(int threads) {
  double best = 0;
  for (int repetition = 0; repetition < 5; ++repetition) {
    double flops = 0;
    float total = 0;
    const auto start = Clock::now();
#pragma omp parallel num_threads(threads) reduction(+ : flops, total)
    {
      float seed = 1;
      flops += HWY_DYNAMIC_DISPATCH(MultiplyAdd)(2'000'000, &seed);
      total += seed;
    }
    best = std::max(best, flops / seconds_since(start) * 1e-9);
    sink = total;
  }
  return best;
}

double triad_bandwidth(int threads) {
  constexpr std::size_t kElements = 10'000'000;
  std::vector<float> a(kElements), b(kElements, 1.f), c(kElements, 2.f);
  double best = 0;
  for (int repetition = 0; repetition < 5; ++repetition) {
    const float s = 0.5f + static_cast<float>(repetition);
    const auto start = Clock::now();
#pragma omp parallel for simd num_threads(threads) schedule(static)
    for (std::size_t i = 0; i < kElements; ++i) a[i] = b[i] + s * c[i];
    best = std::max(best, 12.0 * kElements / seconds_since(start) * 1e-9);
    sink = a[static_cast<std::size_t>(repetition)];
  }
  return best;
}

}  // namespace ballast::bench
#endif
