// What makes the viscous sum exact where particles are not evenly spread: Evening in passes.h.
#if defined(BALLAST_VISCOUS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLAST_VISCOUS_INL_H_
#undef BALLAST_VISCOUS_INL_H_
#else
#define BALLAST_VISCOUS_INL_H_
#endif
#include "fluid_server/passes/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

/// Lane by lane, the correction that a pair along e = r / |r| gets from one of its two.
struct Evenings {
  VF xx, zz, zx, yy, xy, yz;
};

/// The same one for all lanes, and those of the items that `index` names.
template <int Dim>
HWY_INLINE Evenings evening_of(const Evening& c) {
  const F d;
  if constexpr (Dim == 2) return {hn::Set(d, c.xx), hn::Set(d, c.zz), hn::Set(d, c.zx), VF{}, VF{}, VF{}};
  return {hn::Set(d, c.xx), hn::Set(d, c.zz), hn::Set(d, c.zx), hn::Set(d, c.yy), hn::Set(d, c.xy), hn::Set(d, c.yz)};
}
template <int Dim>
HWY_INLINE Evenings evening_of(const std::vector<Evening>& all, const std::uint32_t* index) {
  const Quad first = load_transposed(F(), &all[0].xx, index, 8);
  if constexpr (Dim == 2) return {first.a, first.b, first.c, VF{}, VF{}, VF{}};
  const Quad second = load_transposed(F(), &all[0].xy, index, 8);
  return {first.a, first.b, first.c, first.d, second.a, second.b};
}

/// e.C.e
template <int Dim, class Pair>
HWY_INLINE VF along(const Evenings& c, const Pair& r) {
  VF sum = hn::MulAdd(hn::MulAdd(c.xx, r.x, hn::Mul(c.zx, r.z)), r.x, hn::Mul(hn::Mul(c.zz, r.z), r.z));
  if constexpr (Dim == 3) sum = hn::MulAdd(hn::MulAdd(c.yy, r.y, hn::MulAdd(c.xy, r.x, hn::Mul(c.yz, r.z))), r.y, sum);
  return hn::Div(sum, hn::Max(r.r2, hn::Set(F(), 1e-30f)));
}

/// C of one particle from the second moments of its pairs.
template <int Dim, class Pairs>
HWY_INLINE Evening evening(const Pairs& pairs, std::uint32_t item) {
  const VF zero = hn::Zero(F());
  VF xx = zero, yy = zero, zz = zero, xy = zero, yz = zero, zx = zero;
  pairs.for_each_neighbour(item, [&](const auto& r, const Quad& motion, const std::uint32_t*) HWY_ATTR {
    const VF vg = hn::Mul(hn::Abs(motion.d), r.slope), x = hn::Mul(vg, r.x), z = hn::Mul(vg, r.z);
    xx = hn::MulAdd(x, r.x, xx);
    zz = hn::MulAdd(z, r.z, zz);
    zx = hn::MulAdd(z, r.x, zx);
    if constexpr (Dim == 3) {
      yy = hn::MulAdd(hn::Mul(vg, r.y), r.y, yy);
      xy = hn::MulAdd(x, r.y, xy);
      yz = hn::MulAdd(z, r.y, yz);
    }
  });
  // What is missing: D = 1 + sum V g r r.
  const float dx = 1 + total(xx), dy = Dim == 3 ? 1 + total(yy) : 0, dz = 1 + total(zz);
  const float dxy = total(xy), dyz = total(yz), dzx = total(zx), half = (dx + dy + dz) / 2;
  const float uneven = std::sqrt(dx * dx + dy * dy + dz * dz + 2 * (dxy * dxy + dyz * dyz + dzx * dzx));
  const float share = std::min(std::max(2 - uneven / Evening::kMost, 0.f), 1.f), two = share * (Dim + 2) / 2;
  return {two * dx - share * half,
          two * dz - share * half,
          2 * two * dzx,
          Dim == 3 ? two * dy - share * half : 0.f,
          2 * two * dxy,
          2 * two * dyz,
          {}};
}

/// A weighted sum of vectors, lane by lane.
struct VectorSum {
  VF x, y, z;
  HWY_INLINE void add(VF weight, VF a, VF b, VF c) {
    x = hn::MulAdd(weight, a, x);
    y = hn::MulAdd(weight, b, y);
    z = hn::MulAdd(weight, c, z);
  }
  HWY_INLINE void total_into(float* out) const { out[0] = total(x), out[1] = total(y), out[2] = total(z); }
};

/// Of a boundary sample over its fluid neighbours; all 0 if it is dry.
template <int Dim, class Pairs>
HWY_INLINE ViscousSums viscous_sums(const Pairs& pairs, const ItemExtras& extras, std::uint32_t item) {
  ViscousSums sums{};
  if (pairs.count(item) == 0) return sums;
  const F d;
  const VF zero = hn::Zero(d);
  VectorSum wv{zero, zero, zero}, wd = wv, ar = wv, av = wv;
  VF a = zero;
  pairs.for_each_neighbour(item, [&](const auto& r, const Quad& motion, const std::uint32_t* index) HWY_ATTR {
    const VF volume = hn::Max(motion.d, zero);  // padding is the sample itself, whose volume is negative
    const VF vw = hn::Mul(volume, pairs.value(r.r2)), vg = hn::Mul(volume, r.slope);
    const VF mu = load_transposed(F(), &extras.viscous[0].wx, index, 4).d;
    const VF even = along<Dim>(evening_of<Dim>(extras.evening, index), r);
    const VF mu_g = hn::Mul(hn::Mul(hn::MulAdd(even, mu, mu), hn::Set(d, 2.f)), vg);
    a = hn::Add(a, mu_g);
    wd.add(vw, r.x, r.y, r.z);
    ar.add(mu_g, r.x, r.y, r.z);
    av.add(mu_g, motion.a, motion.b, motion.c);
    wv.add(vw, motion.a, motion.b, motion.c);
  });
  wv.total_into(sums.wv), wd.total_into(sums.wd), ar.total_into(sums.ar), av.total_into(sums.av);
  sums.a = total(a);
  return sums;
}

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
