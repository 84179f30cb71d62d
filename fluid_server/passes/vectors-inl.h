// Vector helpers of the passes: kernels on vectors and transposing loads of records. Included once per instruction set.
#if defined(BALLAST_VECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLAST_VECTORS_INL_H_
#undef BALLAST_VECTORS_INL_H_
#else
#define BALLAST_VECTORS_INL_H_
#endif
#include <hwy/highway.h>

#include "fluid_server/kernel.h"
#include "fluid_server/neighbours/neighbourhood.h"

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes: neighbour lists are about 12 to 75 long, wider vectors waste more in the last one than they gain.
using F = hn::CappedTag<float, 8>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
inline constexpr std::uint32_t kLanes = static_cast<std::uint32_t>(hn::MaxLanes(F()));

/// Four vectors from the four consecutive floats of each lane's neighbour.
struct Quad {
  VF a, b, c, d;
};

#if HWY_TARGET == HWY_SCALAR  // one lane: no transposing, and none of the operations for it
template <class D>
HWY_INLINE Quad load_transposed(D d, const float* base, const std::uint32_t* index, std::uint32_t stride) {
  const float* r = base + static_cast<std::size_t>(index[0]) * stride;
  return {hn::Set(d, r[0]), hn::Set(d, r[1]), hn::Set(d, r[2]), hn::Set(d, r[3])};
}
#else
/// Four floats of the neighbours k and, with eight lanes, k + 4.
template <class D>
HWY_INLINE hn::Vec<D> load_lane_blocks(D d, const float* base, const std::uint32_t* index, std::uint32_t stride,
                                       std::uint32_t k) {
  const hn::FixedTag<float, 4> d4;
  const auto low = hn::LoadU(d4, base + static_cast<std::size_t>(index[k]) * stride);
  if constexpr (hn::MaxLanes(D()) == 8)
    return hn::Combine(d, hn::LoadU(d4, base + static_cast<std::size_t>(index[k + 4]) * stride), low);
  else
    return low;
}

/// Loads 4 floats at base + stride * index[lane] for each lane and transposes them.
template <class D>
HWY_INLINE Quad load_transposed(D d, const float* base, const std::uint32_t* index, std::uint32_t stride) {
  const hn::RepartitionToWide<D> w;
  const auto r0 = load_lane_blocks(d, base, index, stride, 0), r1 = load_lane_blocks(d, base, index, stride, 1);
  const auto r2 = load_lane_blocks(d, base, index, stride, 2), r3 = load_lane_blocks(d, base, index, stride, 3);
  const auto t0 = hn::InterleaveLower(d, r0, r1), t1 = hn::InterleaveLower(d, r2, r3);
  const auto t2 = hn::InterleaveUpper(d, r0, r1), t3 = hn::InterleaveUpper(d, r2, r3);
  return {hn::BitCast(d, hn::InterleaveLower(w, hn::BitCast(w, t0), hn::BitCast(w, t1))),
          hn::BitCast(d, hn::InterleaveUpper(w, hn::BitCast(w, t0), hn::BitCast(w, t1))),
          hn::BitCast(d, hn::InterleaveLower(w, hn::BitCast(w, t2), hn::BitCast(w, t3))),
          hn::BitCast(d, hn::InterleaveUpper(w, hn::BitCast(w, t2), hn::BitCast(w, t3)))};
}
#endif

/// The kernel's constants as floats, and its two functions on vectors of squared distances.
template <KernelKind K>
struct VectorKernel {
  float support2, inverse_h, w_scale, g_scale;
  explicit VectorKernel(const Kernel& k)
      : support2(static_cast<float>(k.support * k.support)),
        inverse_h(static_cast<float>(1 / (K == KernelKind::kCubic ? k.h() : k.support))),
        w_scale(static_cast<float>(k.scale())),
        g_scale(static_cast<float>(K == KernelKind::kCubic ? k.slope_scale() / (k.h() * k.h())
                                                           : -20 * k.slope_scale() / (k.support * k.support))) {}
  HWY_INLINE VF value(VF r2) const {
    const F d;
    const VF q = hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h)), zero = hn::Zero(d);
    if constexpr (K == KernelKind::kCubic) {
      const VF a = hn::Max(hn::Sub(hn::Set(d, 2.f), q), zero), b = hn::Max(hn::Sub(hn::Set(d, 1.f), q), zero);
      const VF a3 = hn::Mul(hn::Mul(a, a), a), b3 = hn::Mul(hn::Mul(b, b), b);
      return hn::Mul(hn::Set(d, w_scale), hn::MulSub(hn::Set(d, 0.25f), a3, b3));
    } else {
      const VF a = hn::Max(hn::Sub(hn::Set(d, 1.f), q), zero), a2 = hn::Mul(a, a);
      return hn::Mul(hn::Mul(hn::Set(d, w_scale), hn::Mul(a2, a2)), hn::MulAdd(hn::Set(d, 4.f), q, hn::Set(d, 1.f)));
    }
  }
  /// g = W'(r) / r.
  HWY_INLINE VF slope(VF r2) const {
    const F d;
    const VF zero = hn::Zero(d);
    if constexpr (K == KernelKind::kCubic) {
      // the floor keeps a particle's pair with itself (padding) finite; its vector r is zero
      const VF q = hn::Max(hn::Mul(hn::Sqrt(r2), hn::Set(d, inverse_h)), hn::Set(d, 1e-6f));
      const VF a = hn::Max(hn::Sub(hn::Set(d, 2.f), q), zero), b = hn::Max(hn::Sub(hn::Set(d, 1.f), q), zero);
      const VF s = hn::MulSub(hn::Mul(hn::Set(d, 3.f), b), b, hn::Mul(hn::Mul(hn::Set(d, 0.75f), a), a));
      return hn::Div(hn::Mul(hn::Set(d, g_scale), s), q);
    } else {
      const VF a = hn::Max(hn::NegMulAdd(hn::Sqrt(r2), hn::Set(d, inverse_h), hn::Set(d, 1.f)), zero);
      return hn::Mul(hn::Mul(hn::Set(d, g_scale), a), hn::Mul(a, a));
    }
  }
};

/// Differences of fixed-point positions in metres.
struct Distances {
  float qx, qy, qz;
  explicit Distances(const Coordinates& c)
      : qx(static_cast<float>(c.quantum[0])),
        qy(static_cast<float>(c.quantum[1])),
        qz(static_cast<float>(c.quantum[2])) {}
  HWY_INLINE VF metres(std::uint32_t own, VF other_bits, float quantum) const {
    const I i;
    const auto difference = hn::Sub(hn::Set(i, static_cast<std::int32_t>(own)), hn::BitCast(i, other_bits));
    return hn::Mul(hn::ConvertTo(F(), difference), hn::Set(F(), quantum));
  }
};

HWY_INLINE float total(VF v) { return hn::GetLane(hn::SumOfLanes(F(), v)); }

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
