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

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
