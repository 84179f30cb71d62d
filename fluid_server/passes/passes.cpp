// Vector code of the passes, compiled once per instruction set and chosen at run time.
#include "fluid_server/passes/passes.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/passes/passes.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
#include "fluid_server/passes/lists-inl.h"
#include "fluid_server/passes/pairs-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

template <class Task>
void for_each_chunk(std::uint32_t size, std::uint32_t chunk, int threads, Task&& task) {
  const std::uint32_t chunks = (size + chunk - 1) / chunk;
#pragma omp parallel for num_threads(threads) schedule(dynamic, 1)
  for (std::uint32_t c = 0; c < chunks; ++c) task(c * chunk, std::min(size, (c + 1) * chunk));
}

template <int Dim, KernelKind K>
void BuildAll(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* pressure) {
  const ListBuilder<Dim> builder(items, constants.kernel);
  const Pairs<Dim, K> pairs(items, extras, constants);
  Lists& lists = items.lists;
  const std::uint32_t size = items.size(), chunks = (size + Lists::kChunk - 1) / Lists::kChunk;
  lists.start.resize(size);
  lists.count.resize(size);
  lists.buffer_of_chunk.resize(chunks);
#pragma omp parallel num_threads(constants.threads)
  {
    const std::uint32_t self = thread_index();
    std::size_t used = 0;
#pragma omp for schedule(dynamic, 1)
    for (std::uint32_t c = 0; c < chunks; ++c) {
      lists.buffer_of_chunk[c] = self;
      const std::uint32_t end = std::min(size, (c + 1) * Lists::kChunk);
      for (std::uint32_t group = c * Lists::kChunk; group < end;) {
        const std::uint32_t next = builder.build_group(group, end, lists, self, used);
        if (pressure)
          for (std::uint32_t i = group; i < next; ++i)
            if (!(items.source[i] & Neighbourhood::kSample)) pressure[items.source[i]] = pairs.advanced_pressure(i);
        group = next;
      }
    }
  }
}

template <int Dim, KernelKind K>
void AdvanceAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* pressure) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  for_each_chunk(static_cast<std::uint32_t>(items.fluid_item.size()), Lists::kChunk, constants.threads,
                 [&](std::uint32_t begin, std::uint32_t end) {
                   for (std::uint32_t f = begin; f < end; ++f)
                     pressure[f] = pairs.advanced_pressure(items.fluid_item[f]);
                 });
}

template <int Dim, KernelKind K>
void GatherAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, SampleSums* sums) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  for_each_chunk(static_cast<std::uint32_t>(items.sample_item.size()), Lists::kChunk, constants.threads,
                 [&](std::uint32_t begin, std::uint32_t end) {
                   for (std::uint32_t s = begin; s < end; ++s) sums[s] = pairs.sample_sums(items.sample_item[s]);
                 });
}

template <int Dim, KernelKind K>
void AccelerateAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* a) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  for_each_chunk(static_cast<std::uint32_t>(items.fluid_item.size()), Lists::kChunk, constants.threads,
                 [&](std::uint32_t begin, std::uint32_t end) {
                   for (std::uint32_t f = begin; f < end; ++f) pairs.acceleration(items.fluid_item[f], a + 3 * f);
                 });
}

template <int Dim, KernelKind K>
void SumAll(const Neighbourhood& items, const PassConstants& constants, float* delta, float* gradient) {
  const Pairs<Dim, K> pairs(items, ItemExtras{}, constants);
  for_each_chunk(static_cast<std::uint32_t>(items.fluid_item.size()), Lists::kChunk, constants.threads,
                 [&](std::uint32_t begin, std::uint32_t end) {
                   for (std::uint32_t f = begin; f < end; ++f)
                     delta[f] = pairs.summed_density(items.fluid_item[f], gradient + 3 * f);
                 });
}

template <int Dim, KernelKind K>
void RowsAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, RowSums* sums) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  for_each_chunk(static_cast<std::uint32_t>(items.fluid_item.size()), Lists::kChunk, constants.threads,
                 [&](std::uint32_t begin, std::uint32_t end) {
                   for (std::uint32_t f = begin; f < end; ++f) sums[f] = pairs.row_sums(items.fluid_item[f]);
                 });
}

/// Fluxes of the samples into their p, then the divergence at every particle; within a parallel region.
template <class P>
HWY_INLINE void diverge(const P& pairs, Neighbourhood& items, const float* inverse_w, const Flow* flow, float* out) {
  const auto samples = static_cast<std::uint32_t>(items.sample_item.size());
  const auto particles = static_cast<std::uint32_t>(items.fluid_item.size());
#pragma omp for schedule(dynamic, Lists::kChunk)
  for (std::uint32_t s = 0; s < samples; ++s)
    if (inverse_w[s] > 0) {
      const std::uint32_t item = items.sample_item[s];
      items.record[item].p = pairs.sample_flux(item, inverse_w[s], flow);
    }
#pragma omp for schedule(dynamic, Lists::kChunk)
  for (std::uint32_t f = 0; f < particles; ++f) out[f] = pairs.volume_divergence(items.fluid_item[f], flow);
}

template <int Dim, KernelKind K>
void ApplyAll(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, const float* inverse_w,
              Flow* flow, float* out) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  const auto samples = static_cast<std::uint32_t>(items.sample_item.size());
  const auto particles = static_cast<std::uint32_t>(items.fluid_item.size());
#pragma omp parallel num_threads(constants.threads)
  {
#pragma omp for schedule(dynamic, Lists::kChunk)
    for (std::uint32_t s = 0; s < samples; ++s) {
      const std::uint32_t item = items.sample_item[s];
      flow[item] = {0, 0, 0, items.record[item].volume};
      items.record[item].p = inverse_w[s] > 0 ? pairs.sample_pressure(item, inverse_w[s]) : 0.f;
    }
#pragma omp for schedule(dynamic, Lists::kChunk)
    for (std::uint32_t f = 0; f < particles; ++f) {
      const std::uint32_t item = items.fluid_item[f];
      flow[item] = pairs.pressure_acceleration(item);
    }
    diverge(pairs, items, inverse_w, flow, out);
  }
}

template <int Dim, KernelKind K>
void DivergeAll(Neighbourhood& items, const PassConstants& constants, const float* inverse_w, const Flow* flow,
                float* out) {
  const Pairs<Dim, K> pairs(items, ItemExtras{}, constants);
#pragma omp parallel num_threads(constants.threads)
  diverge(pairs, items, inverse_w, flow, out);
}

/// Calls what<Dim, K> for the kernel in use.
#define BALLAST_BY_KERNEL(what, kernel, ...)                                             \
  do {                                                                                   \
    if ((kernel).dimension == 2)                                                         \
      (kernel).kind == KernelKind::kCubic ? what<2, KernelKind::kCubic>(__VA_ARGS__)     \
                                          : what<2, KernelKind::kWendland>(__VA_ARGS__); \
    else                                                                                 \
      (kernel).kind == KernelKind::kCubic ? what<3, KernelKind::kCubic>(__VA_ARGS__)     \
                                          : what<3, KernelKind::kWendland>(__VA_ARGS__); \
  } while (false)

void Build(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* pressure) {
  BALLAST_BY_KERNEL(BuildAll, constants.kernel, items, extras, constants, pressure);
}
void Advance(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* pressure) {
  BALLAST_BY_KERNEL(AdvanceAll, constants.kernel, items, extras, constants, pressure);
}
void Gather(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, SampleSums* sums) {
  BALLAST_BY_KERNEL(GatherAll, constants.kernel, items, extras, constants, sums);
}
void Accelerate(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* a) {
  BALLAST_BY_KERNEL(AccelerateAll, constants.kernel, items, extras, constants, a);
}
void Sum(const Neighbourhood& items, const PassConstants& constants, float* delta, float* gradient) {
  BALLAST_BY_KERNEL(SumAll, constants.kernel, items, constants, delta, gradient);
}
void Rows(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, RowSums* sums) {
  BALLAST_BY_KERNEL(RowsAll, constants.kernel, items, extras, constants, sums);
}
void Apply(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, const float* inverse_w,
           Flow* flow, float* out) {
  BALLAST_BY_KERNEL(ApplyAll, constants.kernel, items, extras, constants, inverse_w, flow, out);
}
void Diverge(Neighbourhood& items, const PassConstants& constants, const float* inverse_w, const Flow* flow,
             float* out) {
  BALLAST_BY_KERNEL(DivergeAll, constants.kernel, items, constants, inverse_w, flow, out);
}
const char* Name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ballast::fluid {

HWY_EXPORT(Build);
HWY_EXPORT(Advance);
HWY_EXPORT(Gather);
HWY_EXPORT(Accelerate);
HWY_EXPORT(Sum);
HWY_EXPORT(Rows);
HWY_EXPORT(Apply);
HWY_EXPORT(Diverge);
HWY_EXPORT(Name);

void build_lists_and_advance_pressure(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                                      std::vector<float>& new_pressure) {
  new_pressure.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Build)(items, extras, constants, new_pressure.data());
}
void advance_pressure(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                      std::vector<float>& new_pressure) {
  new_pressure.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Advance)(items, extras, constants, new_pressure.data());
}
void build_lists(Neighbourhood& items, const PassConstants& constants) {
  HWY_DYNAMIC_DISPATCH(Build)(items, ItemExtras{}, constants, nullptr);
}
void gather_samples(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    std::vector<SampleSums>& sums) {
  sums.resize(items.sample_item.size());
  HWY_DYNAMIC_DISPATCH(Gather)(items, extras, constants, sums.data());
}
void accelerate(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                std::vector<float>& acceleration) {
  acceleration.resize(3 * items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Accelerate)(items, extras, constants, acceleration.data());
}
void sum_density(const Neighbourhood& items, const PassConstants& constants, std::vector<float>& delta,
                 std::vector<float>& gradient) {
  delta.resize(items.fluid_item.size());
  gradient.resize(3 * items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Sum)(items, constants, delta.data(), gradient.data());
}
void sum_rows(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
              std::vector<RowSums>& sums) {
  sums.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Rows)(items, extras, constants, sums.data());
}
void apply_pressure(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    const std::vector<float>& inverse_w, std::vector<Flow>& flow, std::vector<float>& out) {
  flow.resize(items.record.size());
  out.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Apply)(items, extras, constants, inverse_w.data(), flow.data(), out.data());
}
void apply_divergence(Neighbourhood& items, const PassConstants& constants, const std::vector<float>& inverse_w,
                      const std::vector<Flow>& flow, std::vector<float>& out) {
  out.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Diverge)(items, constants, inverse_w.data(), flow.data(), out.data());
}
const char* simd_name() { return HWY_DYNAMIC_DISPATCH(Name)(); }

}  // namespace ballast::fluid
#endif
