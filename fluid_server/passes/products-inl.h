// Products of the pressure system from what is kept of all pairs, their slopes: where the sums of pairs-inl.h would
// compute the kernel anew, a load of four bytes per pair. Equations: passes.h.
#if defined(BALLAST_PRODUCTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLAST_PRODUCTS_INL_H_
#undef BALLAST_PRODUCTS_INL_H_
#else
#define BALLAST_PRODUCTS_INL_H_
#endif
#include "fluid_server/passes/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

template <int Dim>
class Products {
 public:
  Products(const Neighbourhood& items, const KeptPairs& pairs)
      : lists_(items.lists),
        pairs_(pairs),
        distances_(items.coordinates()),
        points_(reinterpret_cast<const float*>(pairs.point.data())) {}

  /// Pressure extrapolated onto a sample.
  HWY_INLINE float sample_pressure(std::uint32_t item, float inverse_w) const {
    const F d;
    const float* value = pairs_.values_of(item);
    VF wp = hn::Zero(d);
    for_each_vector(item, [&](std::uint32_t k, const std::uint32_t* index)
                              HWY_ATTR { wp = hn::MulAdd(hn::LoadU(d, value + k), pressures(index), wp); });
    return inverse_w * total(wp);
  }

  /// Acceleration by pressure alone, of a particle with these sums of its row.
  HWY_INLINE Flow acceleration(std::uint32_t item, const KeptPairs::Sum& sum, float mobility, float volume) const {
    const F d;
    VF ax = hn::Zero(d), ay = hn::Zero(d), az = hn::Zero(d);
    for_each_pair(item, [&](std::uint32_t, const std::uint32_t*, const Gradient& g) HWY_ATTR {
      ax = hn::MulAdd(g.x, g.p, ax);
      az = hn::MulAdd(g.z, g.p, az);
      if constexpr (Dim == 3) ay = hn::MulAdd(g.y, g.p, ay);
    });
    const float p = pairs_.point[item].p;
    return {-mobility * (p * sum.x + total(ax)), Dim == 3 ? -mobility * (p * sum.y + total(ay)) : 0.f,
            -mobility * (p * sum.z + total(az)), volume};
  }

  /// Mean of what is in the points' p over a sample's particles.
  HWY_INLINE float mean(std::uint32_t item) const {
    const F d;
    const float* value = pairs_.values_of(item);
    VF w = hn::Zero(d), wp = hn::Zero(d);
    for_each_vector(item, [&](std::uint32_t k, const std::uint32_t* index) HWY_ATTR {
      const VF vw = hn::LoadU(d, value + k);
      w = hn::Add(w, vw);
      wp = hn::MulAdd(vw, pressures(index), wp);
    });
    const float sum = total(w);
    return sum > 0 ? total(wp) / sum : 0.f;
  }

  /// |dF_i / dp_i|^2 / V^2: square of the sum of gradients, those of samples with the share of p_i that they take on.
  HWY_INLINE float own_square(std::uint32_t item, const KeptPairs::Sum& sum, float volume) const {
    float x = sum.x, y = sum.y, z = sum.z;
    if (sum.touches_samples != 0) {
      const F d;
      const float* value = pairs_.values_of(item);
      VF cx = hn::Zero(d), cy = hn::Zero(d), cz = hn::Zero(d);
      for_each_pair(item, [&](std::uint32_t k, const std::uint32_t*, const Gradient& g) HWY_ATTR {
        const VF share = hn::Mul(hn::Set(d, volume), hn::Mul(hn::LoadU(d, value + k), g.p));
        cx = hn::MulAdd(g.x, share, cx);
        cz = hn::MulAdd(g.z, share, cz);
        if constexpr (Dim == 3) cy = hn::MulAdd(g.y, share, cy);
      });
      x += total(cx), y += total(cy), z += total(cz);
    }
    return x * x + z * z + (Dim == 3 ? y * y : 0.f);
  }

  /// Flux into a sample at rest over sum V W: V_b sum V_k g (x_k - x_b).v_k / sum V W.
  HWY_INLINE float sample_flux(std::uint32_t item, float inverse_w, const Flow* flow) const {
    return flow[item].volume * inverse_w * fluxes<false>(item, flow).fluid;
  }

  /// -V_i [ sum V_j g r.(v_i - v_j) + sum_b W_ib flux_b ], fluxes in the samples' p; samples at rest.
  HWY_INLINE float volume_divergence(std::uint32_t item, const KeptPairs::Sum& sum, const Flow* flow) const {
    const Flow& own = flow[item];
    const bool touches_samples = sum.touches_samples != 0;
    const Fluxes flux = touches_samples ? fluxes<true>(item, flow) : fluxes<false>(item, flow);
    float all = own.x * sum.x + own.z * sum.z - flux.fluid;
    if constexpr (Dim == 3) all += own.y * sum.y;
    if (touches_samples) all += flux.handed_on;
    return -own.volume * all;
  }

 private:
  struct Gradient {
    VF x, y, z, p;  // V_j g r, and the neighbour's p
  };

  HWY_INLINE VF pressures(const std::uint32_t* index) const {
    const auto place = hn::ShiftLeft<2>(hn::BitCast(I(), hn::LoadU(U(), index)));
    return hn::GatherIndex(F(), points_ + 3, place);
  }
  template <class Body>
  HWY_INLINE void for_each_vector(std::uint32_t item, Body&& body) const {
    const std::uint32_t* list = lists_.of(item);
    const std::uint32_t count = lists_.count[item];
    for (std::uint32_t k = 0; k < count; k += kLanes) body(k, list + k);
  }
  template <class Body>
  HWY_INLINE void for_each_pair(std::uint32_t item, Body&& body) const {
    const F d;
    const KeptPairs::Point own = pairs_.point[item];
    const float* slope = pairs_.slopes_of(item);
    for_each_vector(item, [&](std::uint32_t k, const std::uint32_t* index) HWY_ATTR {
      const Quad other = load_transposed(d, points_, index, 4);
      const VF vg = hn::LoadU(d, slope + k);
      Gradient g{hn::Mul(vg, distances_.metres(own.x, other.a, distances_.qx)), hn::Zero(d),
                 hn::Mul(vg, distances_.metres(own.z, other.c, distances_.qz)), other.d};
      if constexpr (Dim == 3) g.y = hn::Mul(vg, distances_.metres(own.y, other.b, distances_.qy));
      body(k, index, g);
    });
  }

  struct Fluxes {
    float fluid;      ///< sum V_j g r.v_j
    float handed_on;  ///< sum_b W_ib flux_b
  };
  template <bool kSamples>
  HWY_INLINE Fluxes fluxes(std::uint32_t item, const Flow* flow) const {
    const F d;
    const float* value = kSamples ? pairs_.values_of(item) : nullptr;
    VF sum = hn::Zero(d), from_samples = hn::Zero(d);
    for_each_pair(item, [&](std::uint32_t k, const std::uint32_t* index, const Gradient& g) HWY_ATTR {
      const Quad v = load_transposed(d, &flow->x, index, 4);
      sum = hn::MulAdd(g.x, v.a, sum);
      sum = hn::MulAdd(g.z, v.c, sum);
      if constexpr (Dim == 3) sum = hn::MulAdd(g.y, v.b, sum);
      if constexpr (kSamples) from_samples = hn::MulAdd(hn::LoadU(d, value + k), g.p, from_samples);
    });
    return {total(sum), kSamples ? total(from_samples) : 0.f};
  }

  const Lists& lists_;
  const KeptPairs& pairs_;
  Distances distances_;
  const float* points_;
};

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
