// Products of the pressure system from gradients that are kept for all pairs: two multiplications of a vector per pair
// where the sums of pairs-inl.h would compute distance and kernel anew. Equations: passes.h.
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
  Products(const Lists& lists, const PairGradients& pairs)
      : lists_(lists), pairs_(pairs), pressure_(pairs.pressure.data()) {}

  /// Pressure extrapolated onto a sample.
  HWY_INLINE float sample_pressure(std::uint32_t item, float inverse_w) const {
    const F d;
    const std::uint32_t* list = lists_.of(item);
    const std::uint32_t count = lists_.count[item];
    const float* value = values(item);
    VF wp = hn::Zero(d);
    for (std::uint32_t k = 0; k < count; k += kLanes) wp = hn::MulAdd(hn::LoadU(d, value + k), pressures(list + k), wp);
    return inverse_w * total(wp);
  }

  /// Acceleration by pressure alone, of a particle with these sums of its row.
  HWY_INLINE Flow acceleration(std::uint32_t item, const PairGradients::Sum& sum, float mobility, float volume) const {
    const F d;
    const std::uint32_t* list = lists_.of(item);
    const std::uint32_t count = lists_.count[item];
    const float* gradient = gradients(item);
    VF ax = hn::Zero(d), ay = hn::Zero(d), az = hn::Zero(d);
    for (std::uint32_t k = 0; k < count; k += kLanes, gradient += Dim * kLanes) {
      const VF p = pressures(list + k);
      ax = hn::MulAdd(hn::LoadU(d, gradient), p, ax);
      az = hn::MulAdd(hn::LoadU(d, gradient + kLanes), p, az);
      if constexpr (Dim == 3) ay = hn::MulAdd(hn::LoadU(d, gradient + 2 * kLanes), p, ay);
    }
    const float p = pressure_[item];
    return {-mobility * (p * sum.x + total(ax)), Dim == 3 ? -mobility * (p * sum.y + total(ay)) : 0.f,
            -mobility * (p * sum.z + total(az)), volume};
  }

  /// Mean of what is in `pressure` over a sample's particles.
  HWY_INLINE float mean(std::uint32_t item) const {
    const F d;
    const std::uint32_t* list = lists_.of(item);
    const std::uint32_t count = lists_.count[item];
    const float* value = values(item);
    VF w = hn::Zero(d), wp = hn::Zero(d);
    for (std::uint32_t k = 0; k < count; k += kLanes) {
      const VF vw = hn::LoadU(d, value + k);
      w = hn::Add(w, vw);
      wp = hn::MulAdd(vw, pressures(list + k), wp);
    }
    const float sum = total(w);
    return sum > 0 ? total(wp) / sum : 0.f;
  }

  /// |dF_i / dp_i|^2 / V^2: square of the sum of gradients, those of samples with the share of p_i that they take on.
  HWY_INLINE float own_square(std::uint32_t item, const PairGradients::Sum& sum, float volume) const {
    float x = sum.x, y = sum.y, z = sum.z;
    if (sum.touches_samples) {
      const F d;
      const std::uint32_t* list = lists_.of(item);
      const std::uint32_t count = lists_.count[item];
      const float *gradient = gradients(item), *value = values(item);
      VF cx = hn::Zero(d), cy = hn::Zero(d), cz = hn::Zero(d);
      for (std::uint32_t k = 0; k < count; k += kLanes, gradient += Dim * kLanes) {
        const VF share = hn::Mul(hn::Set(d, volume), hn::Mul(hn::LoadU(d, value + k), pressures(list + k)));
        cx = hn::MulAdd(hn::LoadU(d, gradient), share, cx);
        cz = hn::MulAdd(hn::LoadU(d, gradient + kLanes), share, cz);
        if constexpr (Dim == 3) cy = hn::MulAdd(hn::LoadU(d, gradient + 2 * kLanes), share, cy);
      }
      x += total(cx), y += total(cy), z += total(cz);
    }
    return x * x + z * z + (Dim == 3 ? y * y : 0.f);
  }

  /// Flux into a sample at rest over sum V W: V_b sum V_k g (x_k - x_b).v_k / sum V W.
  HWY_INLINE float sample_flux(std::uint32_t item, float inverse_w, const Flow* flow) const {
    return flow[item].volume * inverse_w * flux(item, flow);
  }

  /// -V_i [ sum V_j g r.(v_i - v_j) + sum_b W_ib flux_b ], fluxes in the samples' pressure; samples at rest.
  HWY_INLINE float volume_divergence(std::uint32_t item, const PairGradients::Sum& sum, const Flow* flow) const {
    const Flow& own = flow[item];
    float all = own.x * sum.x + own.z * sum.z - flux(item, flow);
    if constexpr (Dim == 3) all += own.y * sum.y;
    if (sum.touches_samples) all += sample_pressure(item, 1.f);
    return -own.volume * all;
  }

 private:
  const float* gradients(std::uint32_t item) const {
    return pairs_.gradient.data() + std::size_t{pairs_.place[item]} * (Dim * kLanes);
  }
  const float* values(std::uint32_t item) const {
    return pairs_.value.data() + std::size_t{pairs_.place[item]} * kLanes;
  }
  HWY_INLINE VF pressures(const std::uint32_t* index) const {
    return hn::GatherIndex(F(), pressure_, hn::BitCast(I(), hn::LoadU(U(), index)));
  }

  /// sum V_j g r.v_j
  HWY_INLINE float flux(std::uint32_t item, const Flow* flow) const {
    const F d;
    const std::uint32_t* list = lists_.of(item);
    const std::uint32_t count = lists_.count[item];
    const float* gradient = gradients(item);
    VF sum = hn::Zero(d);
    for (std::uint32_t k = 0; k < count; k += kLanes, gradient += Dim * kLanes) {
      const Quad v = load_transposed(d, &flow->x, list + k, 4);
      sum = hn::MulAdd(hn::LoadU(d, gradient), v.a, sum);
      sum = hn::MulAdd(hn::LoadU(d, gradient + kLanes), v.c, sum);
      if constexpr (Dim == 3) sum = hn::MulAdd(hn::LoadU(d, gradient + 2 * kLanes), v.b, sum);
    }
    return total(sum);
  }

  const Lists& lists_;
  const PairGradients& pairs_;
  const float* pressure_;
};

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
