// Vector code of the passes, compiled once per instruction set and chosen at run time.
#include "fluid_server/passes/passes.h"

#include <algorithm>
#include <limits>

#include "fluid_server/neighbours/shares.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fluid_server/passes/passes.cpp"
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
#include "fluid_server/passes/lists-inl.h"
#include "fluid_server/passes/pairs-inl.h"
#include "fluid_server/passes/products-inl.h"
#include "fluid_server/passes/rows-inl.h"
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

/// The particles' p of the points.
template <class Of>
void set_pressures(const Neighbourhood& items, int threads, KeptPairs& pairs, Of&& of) {
  for_each_in(items.fluid_shares, threads, [&](std::uint32_t f) { pairs.point[items.fluid_item[f]].p = of(f); });
}

template <int Dim, KernelKind K>
void BuildAll(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* pressure) {
  const ListBuilder<Dim> builder(items, constants.kernel);
  const Pairs<Dim, K> pairs(items, extras, constants);
  const auto advance = [&](std::uint32_t begin, std::uint32_t end) {
    if (!pressure) return;
    for (std::uint32_t i = begin; i < end; ++i)
      if (!(items.source[i] & Neighbourhood::kSample)) pressure[items.source[i]] = pairs.advanced_pressure(i);
  };
  if (items.lists.valid)
    items.count_kept(MendAll(items, builder, constants.threads, advance));
  else
    SearchAll(items, builder, constants.threads, advance);
  items.share_out();
}

template <int Dim, KernelKind K>
void AdvanceAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* pressure) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  for_each_in(items.fluid_shares, constants.threads,
              [&](std::uint32_t f) { pressure[f] = pairs.advanced_pressure(items.fluid_item[f]); });
}

template <int Dim, KernelKind K>
void GatherAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, SampleSums* sums) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  for_each_in(items.sample_shares, constants.threads,
              [&](std::uint32_t s) { sums[s] = pairs.sample_sums(items.sample_item[s]); });
}

template <int Dim, KernelKind K>
void GatherViscousAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                      ViscousSums* sums) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  for_each_in(items.sample_shares, constants.threads,
              [&](std::uint32_t s) { sums[s] = viscous_sums<Dim>(pairs, extras, items.sample_item[s]); });
}

template <int Dim, KernelKind K>
void AccelerateAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* a,
                   const std::function<void()>& first) {
  const Pairs<Dim, K> pairs(items, extras, constants);
  // By turns: while particles move, the rigid process is at work, on one of the threads' cores.
  constexpr std::size_t kAtATime = 128;
  const std::size_t n = items.fluid_item.size();
  for_each_by_turns(1 + (n + kAtATime - 1) / kAtATime, constants.threads, [&](std::size_t turn) {
    if (turn == 0 && first) first();
    if (turn == 0) return;
    for (std::size_t f = (turn - 1) * kAtATime; f < std::min(n, turn * kAtATime); ++f)
      pairs.acceleration(items.fluid_item[f], a + 3 * f);
  });
}

template <int Dim, KernelKind K>
void AccelerateSome(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    std::span<const std::uint32_t> particles, float* a) {
  constexpr std::size_t kFew = 64;  // below this a second thread costs more than it brings
  const Pairs<Dim, K> pairs(items, extras, constants);
#pragma omp parallel for num_threads(constants.threads) schedule(static) if (particles.size() > kFew)
  for (std::size_t k = 0; k < particles.size(); ++k) pairs.acceleration(items.fluid_item[particles[k]], a + 3 * k);
}

template <int Dim, KernelKind K>
void SumAll(const Neighbourhood& items, const PassConstants& constants, float* delta, float* gradient) {
  const Pairs<Dim, K> pairs(items, ItemExtras{}, constants);
  for_each_in(items.fluid_shares, constants.threads,
              [&](std::uint32_t f) { delta[f] = pairs.summed_density(items.fluid_item[f], gradient + 3 * f); });
}

template <int Dim, KernelKind K>
void EvenAll(const Neighbourhood& items, const PassConstants& constants, Evening* out) {
  const Pairs<Dim, K> pairs(items, ItemExtras{}, constants);
  for_each_in(items.fluid_shares, constants.threads,
              [&](std::uint32_t f) { out[items.fluid_item[f]] = evening<Dim>(pairs, items.fluid_item[f]); });
}

template <int Dim, KernelKind K>
void UnevennessAll(const Neighbourhood& items, const PassConstants& constants, double spacing, Unevenness* out) {
  const Pairs<Dim, K> pairs(items, ItemExtras{}, constants);
  const float per_value = static_cast<float>(1 / constants.kernel.value(spacing));
  for_each_in(items.fluid_shares, constants.threads,
              [&](std::uint32_t f) { out[f] = pairs.unevenness(items.fluid_item[f], per_value); });
}

template <int Dim, KernelKind K>
void RowsAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, RowSums* sums,
             KeptPairs& kept) {
  const Rows<Dim, K> rows(items, extras, constants);
  kept.make_room_for_slopes(items, kLanes, constants.threads);
  for_each_in(items.fluid_shares, constants.threads, [&](std::uint32_t f) {
    const std::uint32_t item = items.fluid_item[f];
    sums[f] = rows.row_sums(item, kept.slopes_of(item), kept.sum[f]);
  });
  kept.make_room_for_values(items, constants.threads);
  for_each_in(items.fluid_shares, constants.threads, [&](std::uint32_t f) {
    if (kept.sum[f].touches_samples != 0) rows.keep_values(items.fluid_item[f], kept.values_of(items.fluid_item[f]));
  });
  for_each_in(items.sample_shares, constants.threads, [&](std::uint32_t s) {
    const std::uint32_t item = items.sample_item[s];
    rows.keep_sample(item, kept.slopes_of(item), kept.values_of(item));
  });
}

template <int Dim>
void AverageAll(const Neighbourhood& items, const PassConstants& constants, KeptPairs& pairs, const float* x,
                float* out) {
  const Products<Dim> products(items, pairs);
  set_pressures(items, constants.threads, pairs, [x](std::uint32_t f) { return x[f]; });
  for_each_in(items.sample_shares, constants.threads,
              [&](std::uint32_t s) { out[s] = products.mean(items.sample_item[s]); });
}

template <int Dim>
void DiagonalAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                 const RowSums* sums, KeptPairs& pairs, float* out) {
  const Products<Dim> products(items, pairs);
  set_pressures(items, constants.threads, pairs, [](std::uint32_t) { return 0.f; });
  for (const KeptPairs::Active& sample : pairs.active) pairs.point[sample.item].p = sample.inverse_w;
  for_each_in(items.fluid_shares, constants.threads, [&](std::uint32_t f) {
    const std::uint32_t item = items.fluid_item[f];
    const float volume = items.record[item].volume;
    const float density = extras.density[constants.several_densities ? item : 0];
    out[f] = volume * (products.own_square(item, pairs.sum[f], volume) / density + volume * sums[f].square);
  });
}

/// Every thread has the same share of the particles, and of the samples that extrapolate, in all products of a solve.
template <int Dim>
void ApplyAll(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, KeptPairs& pairs,
              const float* x, Flow* flow, float* out) {
  const Products<Dim> products(items, pairs);
  KeptPairs::Point* point = pairs.point.data();
  const int threads = constants.threads;
  for_each_in(items.fluid_shares, threads, [&](std::uint32_t f) { point[items.fluid_item[f]].p = x[f]; });
  for_each_in(pairs.active_shares, threads, [&](std::uint32_t s) {
    const KeptPairs::Active sample = pairs.active[s];
    point[sample.item].p = products.sample_pressure(sample.item, sample.inverse_w);
  });
  for_each_in(items.fluid_shares, threads, [&](std::uint32_t f) {
    const std::uint32_t item = items.fluid_item[f];
    const float density = extras.density[constants.several_densities ? item : 0];
    flow[item] = products.acceleration(item, pairs.sum[f], 1 / density, items.record[item].volume);
  });
  for_each_in(pairs.active_shares, threads, [&](std::uint32_t s) {
    const KeptPairs::Active sample = pairs.active[s];
    point[sample.item].p = products.sample_flux(sample.item, sample.inverse_w, flow);
  });
  for_each_in(items.fluid_shares, threads,
              [&](std::uint32_t f) { out[f] = products.volume_divergence(items.fluid_item[f], pairs.sum[f], flow); });
}

/// Fluxes of the samples into their p, then the divergence and Q at every particle.
template <int Dim, KernelKind K>
void DivergeAll(Neighbourhood& items, const PassConstants& constants, const float* inverse_w, const Flow* flow,
                float* out, float* invariant) {
  const Rows<Dim, K> rows(items, ItemExtras{}, constants);
  for_each_in(items.sample_shares, constants.threads, [&](std::uint32_t s) {
    const std::uint32_t item = items.sample_item[s];
    if (inverse_w[s] > 0) items.record[item].p = rows.sample_flux(item, inverse_w[s], flow);
  });
  for_each_in(items.fluid_shares, constants.threads,
              [&](std::uint32_t f) { out[f] = rows.volume_divergence(items.fluid_item[f], flow, invariant[f]); });
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
void GatherViscous(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                   ViscousSums* sums) {
  BALLAST_BY_KERNEL(GatherViscousAll, constants.kernel, items, extras, constants, sums);
}
void Accelerate(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, float* a,
                const std::function<void()>& first) {
  BALLAST_BY_KERNEL(AccelerateAll, constants.kernel, items, extras, constants, a, first);
}
void AccelerateThese(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                     std::span<const std::uint32_t> particles, float* a) {
  BALLAST_BY_KERNEL(AccelerateSome, constants.kernel, items, extras, constants, particles, a);
}
void Sum(const Neighbourhood& items, const PassConstants& constants, float* delta, float* gradient) {
  BALLAST_BY_KERNEL(SumAll, constants.kernel, items, constants, delta, gradient);
}
void Uneven(const Neighbourhood& items, const PassConstants& constants, double spacing, Unevenness* out) {
  BALLAST_BY_KERNEL(UnevennessAll, constants.kernel, items, constants, spacing, out);
}
void Even(const Neighbourhood& items, const PassConstants& constants, Evening* out) {
  BALLAST_BY_KERNEL(EvenAll, constants.kernel, items, constants, out);
}
void SumRows(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, RowSums* sums,
             KeptPairs& pairs) {
  BALLAST_BY_KERNEL(RowsAll, constants.kernel, items, extras, constants, sums, pairs);
}
void Apply(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, KeptPairs& pairs,
           const float* x, Flow* flow, float* out) {
  const auto apply = constants.kernel.dimension == 2 ? ApplyAll<2> : ApplyAll<3>;
  apply(items, extras, constants, pairs, x, flow, out);
}
void Diverge(Neighbourhood& items, const PassConstants& constants, const float* inverse_w, const Flow* flow, float* out,
             float* invariant) {
  BALLAST_BY_KERNEL(DivergeAll, constants.kernel, items, constants, inverse_w, flow, out, invariant);
}
void Average(const Neighbourhood& items, const PassConstants& constants, KeptPairs& pairs, const float* x, float* out) {
  const auto average = constants.kernel.dimension == 2 ? AverageAll<2> : AverageAll<3>;
  average(items, constants, pairs, x, out);
}
void Diagonal(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants, const RowSums* sums,
              KeptPairs& pairs, float* out) {
  const auto diagonal = constants.kernel.dimension == 2 ? DiagonalAll<2> : DiagonalAll<3>;
  diagonal(items, extras, constants, sums, pairs, out);
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
HWY_EXPORT(GatherViscous);
HWY_EXPORT(Accelerate);
HWY_EXPORT(AccelerateThese);
HWY_EXPORT(Sum);
HWY_EXPORT(Uneven);
HWY_EXPORT(Even);
HWY_EXPORT(SumRows);
HWY_EXPORT(Average);
HWY_EXPORT(Diagonal);
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
  resize_gently(sums, items.sample_item.size());
  HWY_DYNAMIC_DISPATCH(Gather)(items, extras, constants, sums.data());
}
void gather_viscous(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    std::vector<ViscousSums>& sums) {
  resize_gently(sums, items.sample_item.size());
  HWY_DYNAMIC_DISPATCH(GatherViscous)(items, extras, constants, sums.data());
}
void accelerate(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                std::vector<float>& acceleration, const std::function<void()>& first) {
  acceleration.resize(3 * items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Accelerate)(items, extras, constants, acceleration.data(), first);
}
void accelerate_some(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                     std::span<const std::uint32_t> particles, std::vector<float>& acceleration) {
  acceleration.resize(3 * particles.size());
  HWY_DYNAMIC_DISPATCH(AccelerateThese)(items, extras, constants, particles, acceleration.data());
}
void sum_density(const Neighbourhood& items, const PassConstants& constants, std::vector<float>& delta,
                 std::vector<float>& gradient) {
  delta.resize(items.fluid_item.size());
  gradient.resize(3 * items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Sum)(items, constants, delta.data(), gradient.data());
}
void find_unevenness(const Neighbourhood& items, const PassConstants& constants, double spacing,
                     std::vector<Unevenness>& out) {
  out.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Uneven)(items, constants, spacing, out.data());
}
void find_evening(const Neighbourhood& items, const PassConstants& constants, std::vector<Evening>& out) {
  out.resize(items.size() + Neighbourhood::kTail);
  HWY_DYNAMIC_DISPATCH(Even)(items, constants, out.data());
}
void sum_rows(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
              std::vector<RowSums>& sums, KeptPairs& pairs) {
  sums.resize(items.fluid_item.size());
  pairs.sum.resize(items.fluid_item.size());
  resize_gently(pairs.point, items.record.size());
#pragma omp parallel for num_threads(constants.threads) schedule(static)
  for (std::size_t i = 0; i < items.record.size(); ++i)
    pairs.point[i] = {items.record[i].x, items.record[i].y, items.record[i].z, 0.f};
  HWY_DYNAMIC_DISPATCH(SumRows)(items, extras, constants, sums.data(), pairs);
}
void average_onto_samples(const Neighbourhood& items, const PassConstants& constants, KeptPairs& pairs,
                          std::span<const float> x, std::vector<float>& out) {
  out.resize(items.sample_item.size());
  HWY_DYNAMIC_DISPATCH(Average)(items, constants, pairs, x.data(), out.data());
}
void weigh_samples(const Neighbourhood& items, std::span<const float> inverse_w, int threads, KeptPairs& pairs,
                   std::vector<Flow>& flow) {
  resize_gently(flow, items.record.size());
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::size_t s = 0; s < inverse_w.size(); ++s) {
    const std::uint32_t item = items.sample_item[s];
    flow[item] = {0, 0, 0, items.record[item].volume};
    pairs.point[item].p = 0;
  }
  resize_gently(pairs.active, static_cast<std::size_t>(std::count_if(inverse_w.begin(), inverse_w.end(),
                                                                     [](float weight) { return weight > 0; })));
  std::size_t found = 0;
  for (std::size_t s = 0; s < inverse_w.size(); ++s)
    if (inverse_w[s] > 0) pairs.active[found++] = {items.sample_item[s], inverse_w[s]};
  pairs.active_shares = shares_of(static_cast<std::uint32_t>(pairs.active.size()), threads,
                                  [&](std::uint32_t k) { return 4 + items.lists.cost(pairs.active[k].item); });
}
void find_diagonal(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                   const std::vector<RowSums>& sums, KeptPairs& pairs, std::vector<float>& out) {
  out.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Diagonal)(items, extras, constants, sums.data(), pairs, out.data());
}
void apply_pressure(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    KeptPairs& pairs, std::span<const float> x, std::vector<Flow>& flow, std::vector<float>& out) {
  out.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Apply)(items, extras, constants, pairs, x.data(), flow.data(), out.data());
}
void apply_divergence(Neighbourhood& items, const PassConstants& constants, const std::vector<float>& inverse_w,
                      const std::vector<Flow>& flow, std::vector<float>& out, std::vector<float>& invariant) {
  out.resize(items.fluid_item.size());
  invariant.resize(items.fluid_item.size());
  HWY_DYNAMIC_DISPATCH(Diverge)(items, constants, inverse_w.data(), flow.data(), out.data(), invariant.data());
}
const char* simd_name() { return HWY_DYNAMIC_DISPATCH(Name)(); }

}  // namespace ballast::fluid
#endif
