// The implicit solver's sums over pairs: rows of the pressure system, and its divergence. Equations: passes.h.
#if defined(BALLAST_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLAST_ROWS_INL_H_
#undef BALLAST_ROWS_INL_H_
#else
#define BALLAST_ROWS_INL_H_
#endif
#include "fluid_server/passes/pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

template <int Dim, KernelKind K>
class Rows {
 public:
  using Pair = typename Pairs<Dim, K>::Pair;

  Rows(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants)
      : items_(items), pairs_(items, extras, constants) {}

  /// What a row of the pressure system needs. Keeps the pairs' slopes, and the sum of their gradients.
  HWY_INLINE RowSums row_sums(std::uint32_t item, float* slopes, KeptPairs::Sum& whole) const {
    const F d;
    const VF zero = hn::Zero(d);
    VF w = zero, fluid = zero, solid = zero, square = zero, sx = zero, sy = zero, sz = zero, from_samples = zero;
    pairs_.for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t* index) HWY_ATTR {
      const VF volume = hn::Abs(motion.d), vg = hn::Mul(volume, r.slope), value = pairs_.value(r.r2);
      const auto sample = hn::Lt(motion.d, zero);
      w = hn::MulAdd(volume, value, w);
      const VF part = hn::Mul(vg, r.r2);
      fluid = hn::Sub(fluid, hn::IfThenZeroElse(sample, part));
      solid = hn::Sub(solid, hn::IfThenElseZero(sample, part));
      sx = hn::Add(sx, hn::Mul(vg, r.x));
      sz = hn::Add(sz, hn::Mul(vg, r.z));
      if constexpr (Dim == 3) sy = hn::Add(sy, hn::Mul(vg, r.y));
      hn::StoreU(vg, d, slopes);
      slopes += kLanes;
      from_samples = hn::Add(from_samples, hn::IfThenElseZero(sample, value));
      const VF g2 = hn::Mul(hn::Mul(vg, r.slope), hn::Div(r.r2, pairs_.densities(index)));
      square = hn::Add(square, hn::IfThenZeroElse(sample, g2));
    });
    whole = {total(sx), total(sy), total(sz), total(from_samples)};
    const float room = 1 - total(solid) / Dim;
    return {total(w) + pairs_.self_value(item), total(fluid) / (Dim * std::max(room, Pairs<Dim, K>::kLeastRoom)),
            total(square), room};
  }

  /// Keeps W of a particle's pairs with samples.
  HWY_INLINE void keep_values(std::uint32_t item, float* values) const {
    const F d;
    pairs_.for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t*) HWY_ATTR {
      hn::StoreU(hn::IfThenElseZero(hn::Lt(motion.d, hn::Zero(d)), pairs_.value(r.r2)), d, values);
      values += kLanes;
    });
  }

  /// Keeps a sample's slopes, and V W of its neighbours.
  HWY_INLINE void keep_sample(std::uint32_t item, float* slopes, float* values) const {
    const F d;
    pairs_.for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t*) HWY_ATTR {
      const VF volume = hn::Max(motion.d, hn::Zero(d));
      hn::StoreU(hn::Mul(volume, r.slope), d, slopes);
      hn::StoreU(hn::Mul(volume, pairs_.value(r.r2)), d, values);
      slopes += kLanes, values += kLanes;
    });
  }

  /// Flux into a sample over sum V W: V_b sum V_k g (x_k - x_b).(v_k - v_b) / sum V W.
  HWY_INLINE float sample_flux(std::uint32_t item, float inverse_w, const Flow* flow) const {
    const Flow& own = flow[item];
    VF flux = hn::Zero(F());
    pairs_.for_each_flow(item, flow, [&](const Pair& r, const Quad& motion) HWY_ATTR {
      const VF volume = hn::Max(motion.d, hn::Zero(F()));
      flux = hn::MulAdd(hn::Mul(volume, r.slope), closing(r, against(own, motion)), flux);
    });
    return -own.volume * inverse_w * total(flux);
  }

  /// -V_i [ sum V_j g r.(v_i - v_j) + sum_b W_ib flux_b ], fluxes in p of the samples; and Q of the fluid around.
  HWY_INLINE float volume_divergence(std::uint32_t item, const Flow* flow, float& invariant) const {
    const F d;
    const Flow& own = flow[item];
    const VF zero = hn::Zero(d);
    VF sum = zero, full = zero;
    VF xx = zero, xy = zero, xz = zero, yx = zero, yy = zero, yz = zero, zx = zero, zy = zero, zz = zero;
    pairs_.for_each_flow(item, flow, [&](const Pair& r, const Quad& motion) HWY_ATTR {
      const VF vg = hn::Mul(hn::Max(motion.d, zero), r.slope);
      const Velocity v = against(own, motion);
      const VF gx = hn::Mul(vg, r.x), gz = hn::Mul(vg, r.z);
      full = hn::NegMulAdd(vg, r.r2, full);
      xx = hn::NegMulAdd(gx, v.x, xx), xz = hn::NegMulAdd(gx, v.z, xz);
      zx = hn::NegMulAdd(gz, v.x, zx), zz = hn::NegMulAdd(gz, v.z, zz);
      if constexpr (Dim == 3) {
        const VF gy = hn::Mul(vg, r.y);
        xy = hn::NegMulAdd(gx, v.y, xy), zy = hn::NegMulAdd(gz, v.y, zy);
        yx = hn::NegMulAdd(gy, v.x, yx), yy = hn::NegMulAdd(gy, v.y, yy), yz = hn::NegMulAdd(gy, v.z, yz);
      }
      sum = hn::MulAdd(hn::Mul(hn::Abs(motion.d), r.slope), closing(r, v), sum);
      const auto sample = hn::Lt(motion.d, hn::Zero(d));
      if (!hn::AllFalse(d, sample)) sum = hn::Add(sum, hn::IfThenElseZero(sample, hn::Mul(r.p, pairs_.value(r.r2))));
    });
    const float around = std::max(total(full) / Dim, kLeastAround), x = total(xx), y = total(yy), z = total(zz);
    const float square =
        x * x + y * y + z * z + 2 * (total(xy) * total(yx) + total(xz) * total(zx) + total(yz) * total(zy));
    invariant = -0.5f * (square - (x + y + z) * (x + y + z) / Dim) / (around * around);
    return -own.volume * total(sum);
  }

 private:
  static constexpr float kLeastAround = 0.3f;  // fullness by which a gradient is corrected for what solids take up

  struct Velocity {
    VF x, y, z;
  };
  /// v_i - v_j
  HWY_INLINE Velocity against(const Flow& own, const Quad& motion) const {
    const F d;
    return {hn::Sub(hn::Set(d, own.x), motion.a), hn::Sub(hn::Set(d, own.y), motion.b),
            hn::Sub(hn::Set(d, own.z), motion.c)};
  }
  /// r.(v_i - v_j)
  HWY_INLINE VF closing(const Pair& r, const Velocity& v) const {
    VF dot = hn::MulAdd(v.x, r.x, hn::Mul(v.z, r.z));
    if constexpr (Dim == 3) dot = hn::MulAdd(v.y, r.y, dot);
    return dot;
  }

  const Neighbourhood& items_;
  const Pairs<Dim, K> pairs_;
};

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
