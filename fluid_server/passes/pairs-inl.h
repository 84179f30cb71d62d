// The sums over pairs, one item at a time: continuity and diffusion, sample sums, acceleration, summed density.
// Equations: passes.h.
#if defined(BALLAST_PAIRS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BALLAST_PAIRS_INL_H_
#undef BALLAST_PAIRS_INL_H_
#else
#define BALLAST_PAIRS_INL_H_
#endif
#include "fluid_server/passes/vectors-inl.h"
#include "fluid_server/passes/viscous-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ballast::fluid {
namespace HWY_NAMESPACE {

template <int Dim, KernelKind K>
class Pairs {
 public:
  Pairs(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants)
      : items_(items),
        extras_(extras),
        constants_(constants),
        kernel_(constants.kernel),
        distances_(items.coordinates()),
        base_(reinterpret_cast<const float*>(items.record.data())) {}

  /// Pressure after dt of continuity and density diffusion, Pa.
  HWY_INLINE float advanced_pressure(std::uint32_t item) const {
    const F d;
    const Record& own = items_.record[item];
    const float rho = density(item), c = constants_.sound_speed;
    const VF pi = hn::Set(d, own.p), vx = hn::Set(d, own.vx), vy = hn::Set(d, own.vy), vz = hn::Set(d, own.vz);
    const VF hx = hn::Set(d, rho * constants_.gravity[0]), hy = hn::Set(d, rho * constants_.gravity[1]);
    const VF hz = hn::Set(d, rho * constants_.gravity[2]), zero = hn::Zero(d);
    VF divergence = zero, of_fluid = zero, diffusion = zero, fullness = zero, fluid = zero;
    for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t*) HWY_ATTR {
      const VF vg = hn::Mul(hn::Abs(motion.d), r.slope);
      VF approach = hn::MulAdd(hn::Sub(vx, motion.a), r.x, hn::Mul(hn::Sub(vz, motion.c), r.z));
      VF excess = hn::MulAdd(hx, r.x, hn::MulAdd(hz, r.z, hn::Sub(r.p, pi)));
      if constexpr (Dim == 3) {
        approach = hn::MulAdd(hn::Sub(vy, motion.b), r.y, approach);
        excess = hn::MulAdd(hy, r.y, excess);
      }
      divergence = hn::MulAdd(vg, approach, divergence);
      fullness = hn::NegMulAdd(vg, r.r2, fullness);
      const VF fluid_g = hn::Mul(hn::Max(motion.d, zero), r.slope);  // samples carry no density of their own
      of_fluid = hn::MulAdd(fluid_g, approach, of_fluid);
      diffusion = hn::MulAdd(fluid_g, excess, diffusion);
      fluid = hn::NegMulAdd(fluid_g, r.r2, fluid);
    });
    const float h = static_cast<float>(constants_.kernel.h());
    const float rate = rho * c * c * total(divergence) - 2 * constants_.diffusion * h * c * total(diffusion);
    float p = own.p + constants_.dt * rate;
    const float water = total(fluid), room = std::max(Dim - (total(fullness) - water), kLeastRoom * Dim);
    // Beside air, a solid that moves away makes room for air, not for water: no drop of the pressure, nor tension.
    const float left = std::max(rho * c * c * constants_.dt * (total(of_fluid) - total(divergence)), 0.f);
    const float least = water > kBacked * Dim ? std::max(own.p, 0.f) : 0.f;
    if (total(fullness) < kOpen * Dim) p = std::max(p, std::min(p + left, least));
    // Spray bears no tension, and a lone drop no pressure; particles would bind to molecules otherwise.
    const bool spray = total(fullness) < kSpray * Dim || water < kSprayAtWall * room;
    return (spray && p < 0) || items_.lists.count[item] == 0 ? 0.f : p;
  }

  /// Sums of a boundary sample over its fluid neighbours.
  HWY_INLINE SampleSums sample_sums(std::uint32_t item) const {
    SampleSums s{};
    if (items_.lists.count[item] == 0) return s;
    const F d;
    const VF zero = hn::Zero(d);
    VF w = zero, wp = zero, wrx = zero, wry = zero, wrz = zero, gx = zero, gy = zero, gz = zero, px = zero, py = zero,
       pz = zero;
    VF nearest2 = hn::Set(d, kernel_.support2);
    for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t* index) HWY_ATTR {
      const VF volume = hn::Max(motion.d, zero);  // padding is the sample itself, whose volume is negative
      const VF vw = hn::Mul(volume, kernel_.value(r.r2)), vg = hn::Mul(volume, r.slope);
      const VF rho = densities(index);
      nearest2 = hn::Min(nearest2, hn::IfThenElse(hn::Gt(volume, zero), r.r2, nearest2));
      w = hn::Add(w, vw);
      wp = hn::MulAdd(vw, r.p, wp);
      const VF vwr = hn::Mul(vw, rho);
      wrx = hn::MulAdd(vwr, r.x, wrx);
      wrz = hn::MulAdd(vwr, r.z, wrz);
      gx = hn::MulAdd(vg, r.x, gx);
      gz = hn::MulAdd(vg, r.z, gz);
      const VF pvg = hn::Mul(hn::Add(r.p, dissipation(item, r, motion, rho, index)), vg);
      px = hn::MulAdd(pvg, r.x, px);
      pz = hn::MulAdd(pvg, r.z, pz);
      if constexpr (Dim == 3) {
        wry = hn::MulAdd(vwr, r.y, wry);
        gy = hn::MulAdd(vg, r.y, gy);
        py = hn::MulAdd(pvg, r.y, py);
      }
    });
    s = {total(w),
         total(wp),
         {total(wrx), total(wry), total(wrz)},
         {total(gx), total(gy), total(gz)},
         {total(px), total(py), total(pz)},
         std::sqrt(hn::GetLane(hn::MinOfLanes(d, nearest2))),
         1.f};
    return s;
  }

  /// Acceleration of a particle, m/s^2.
  HWY_INLINE void acceleration(std::uint32_t item, float* out) const {
    constants_.viscous ? acceleration_of<true>(item, out) : acceleration_of<false>(item, out);
  }
  template <bool kViscous>
  HWY_INLINE void acceleration_of(std::uint32_t item, float* out) const {
    const F d;
    const Record& own = items_.record[item];
    const float rho = density(item);
    const VF pi = hn::Set(d, own.p), rho_i = hn::Set(d, rho);
    VF ax = hn::Zero(d), ay = hn::Zero(d), az = hn::Zero(d);
    VF vx = hn::Zero(d), vy = hn::Zero(d), vz = hn::Zero(d);
    const Evenings own_evening = evening_of<Dim>(kViscous ? extras_.evening[item] : Evening{});
    for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t* index) HWY_ATTR {
      const VF vg = hn::Mul(hn::Abs(motion.d), r.slope);
      const VF pair_rho = constants_.several_densities ? pair_density(rho_i, motion, index) : rho_i;
      const VF s = hn::Mul(vg, hn::Add(hn::Add(pi, r.p), dissipation(item, r, motion, pair_rho, index)));
      ax = hn::NegMulAdd(s, r.x, ax);
      az = hn::NegMulAdd(s, r.z, az);
      if constexpr (Dim == 3) ay = hn::NegMulAdd(s, r.y, ay);
      if constexpr (kViscous) {
        const Quad viscous = load_transposed(F(), &extras_.viscous[0].wx, index, 4);
        const VF own_mu = hn::Set(d, extras_.viscous[item].mu);
        const auto sample = hn::Lt(viscous.d, hn::Zero(d));
        const VF other_mu = hn::IfThenElse(sample, own_mu, viscous.d);
        const VF own_even = along<Dim>(own_evening, r), even = along<Dim>(evening_of<Dim>(extras_.evening, index), r);
        const VF mean_even = hn::Mul(hn::Set(d, 0.5f), hn::Add(own_even, hn::IfThenElse(sample, own_even, even)));
        const VF mu = hn::Mul(hn::Mul(hn::Add(own_mu, other_mu), hn::Add(hn::Set(d, 1.f), mean_even)), vg);
        vx = hn::MulAdd(mu, hn::Sub(hn::Set(d, own.vx), viscous.a), vx);
        vy = hn::MulAdd(mu, hn::Sub(hn::Set(d, own.vy), viscous.b), vy);
        vz = hn::MulAdd(mu, hn::Sub(hn::Set(d, own.vz), viscous.c), vz);
      }
    });
    out[0] = (total(ax) + total(vx)) / rho + constants_.gravity[0];
    out[1] = Dim == 3 ? (total(ay) + total(vy)) / rho + constants_.gravity[1] : 0.f;
    out[2] = (total(az) + total(vz)) / rho + constants_.gravity[2];
  }

  /// sum V W, and its gradient into out[3].
  HWY_INLINE float summed_density(std::uint32_t item, float* out) const {
    const F d;
    VF w = hn::Zero(d), gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t*) HWY_ATTR {
      const VF volume = hn::Abs(motion.d), vg = hn::Mul(volume, r.slope);
      w = hn::MulAdd(volume, kernel_.value(r.r2), w);
      gx = hn::MulAdd(vg, r.x, gx);
      gy = hn::MulAdd(vg, r.y, gy);
      gz = hn::MulAdd(vg, r.z, gz);
    });
    out[0] = total(gx);
    out[1] = Dim == 3 ? total(gy) : 0.f;
    out[2] = total(gz);
    return total(w) + self_value(item);
  }

  HWY_INLINE Unevenness unevenness(std::uint32_t item, float per_value) const {
    const F d;
    const VF zero = hn::Zero(d), scale = hn::Set(d, per_value), fifth = hn::Set(d, 0.2f);
    const Record& own = items_.record[item];
    VF px = zero, py = zero, pz = zero, gx = zero, gy = zero, gz = zero, full = zero, solid = zero, fastest = zero;
    for_each_neighbour(item, [&](const Pair& r, const Quad& motion, const std::uint32_t*) HWY_ATTR {
      const auto sample = hn::Lt(motion.d, zero);
      const VF vg = hn::Mul(hn::Abs(motion.d), r.slope);
      full = hn::NegMulAdd(vg, r.r2, full);
      solid = hn::Sub(solid, hn::IfThenElseZero(sample, hn::Mul(vg, r.r2)));
      const VF near = hn::Mul(kernel_.value(r.r2), scale), near2 = hn::Mul(near, near);
      const VF push = hn::MulAdd(hn::Mul(fifth, hn::Mul(near2, near2)), vg, vg);
      px = hn::NegMulAdd(push, r.x, px);
      pz = hn::NegMulAdd(push, r.z, pz);
      const VF both = hn::IfThenElse(sample, vg, hn::Add(vg, vg));
      gx = hn::MulAdd(both, r.x, gx);
      gz = hn::MulAdd(both, r.z, gz);
      const VF vx = hn::Sub(hn::Set(d, own.vx), motion.a), vy = hn::Sub(hn::Set(d, own.vy), motion.b);
      const VF vz = hn::Sub(hn::Set(d, own.vz), motion.c);
      VF v2 = hn::MulAdd(vx, vx, hn::Mul(vz, vz));
      if constexpr (Dim == 3) {
        py = hn::NegMulAdd(push, r.y, py);
        gy = hn::MulAdd(both, r.y, gy);
        v2 = hn::MulAdd(vy, vy, v2);
      }
      const auto none = hn::Or(sample, hn::Eq(r.slope, zero));  // no slope: beyond the kernel
      fastest = hn::Max(fastest, hn::IfThenZeroElse(none, v2));
    });
    return {{total(px), total(py), total(pz)},
            {total(gx), total(gy), total(gz)},
            std::sqrt(hn::GetLane(hn::MaxOfLanes(d, fastest))),
            total(full) / Dim,
            total(solid) / Dim,
            0};
  }

  struct Pair {
    VF x, y, z, r2, slope, p;  // r = x_i - x_j and its square, g, neighbour's pressure
  };

  template <class Body>
  HWY_INLINE void for_each_neighbour(std::uint32_t item, Body&& body) const {
    const Record& own = items_.record[item];
    const std::uint32_t* list = items_.lists.of(item);
    const std::uint32_t count = items_.lists.count[item];
    for (std::uint32_t k = 0; k < count; k += kLanes)
      body(pair(own, list + k), load_transposed(F(), base_ + 4, list + k, 8), list + k);
  }
  /// The same with the neighbours' motion from `flow`.
  template <class Body>
  HWY_INLINE void for_each_flow(std::uint32_t item, const Flow* flow, Body&& body) const {
    const Record& own = items_.record[item];
    const std::uint32_t* list = items_.lists.of(item);
    const std::uint32_t count = items_.lists.count[item];
    for (std::uint32_t k = 0; k < count; k += kLanes)
      body(pair(own, list + k), load_transposed(F(), &flow->x, list + k, 4));
  }

  /// W(0) V, less what the padding of the list (pairs with itself) added.
  HWY_INLINE float self_value(std::uint32_t item) const {
    const std::uint32_t count = items_.lists.count[item], padding = (count + kLanes - 1) / kLanes * kLanes - count;
    const float self = std::abs(items_.record[item].volume) * static_cast<float>(constants_.kernel.value(0));
    return self * (1.f - static_cast<float>(padding));
  }

  HWY_INLINE VF densities(const std::uint32_t* index) const {
    if (!constants_.several_densities) return hn::Set(F(), extras_.density[0]);
    return hn::GatherIndex(F(), extras_.density.data(), hn::BitCast(I(), hn::LoadU(U(), index)));
  }

  std::uint32_t count(std::uint32_t item) const { return items_.lists.count[item]; }

  /// W of vectors of squared distances.
  HWY_INLINE VF value(VF r2) const { return kernel_.value(r2); }

  static constexpr float kLeastRoom = 0.15f;  // share of its surroundings that solids leave a particle, at least

 private:
  // -sum V r . grad W is the dimension inside the fluid and about 0.8 of it at a flat surface; below half of it is
  // spray, and below a fifth of the room that solids leave: a pair of drops on a wall, whose samples fill half of what
  // is around. With 0.8 the surface's own noise is rectified to pressure and throws particles up.
  static constexpr float kSpray = 0.5f, kSprayAtWall = 0.2f, kOpen = 0.9f, kBacked = 0.6f;
  // Below kOpen air is near; above kBacked, by water alone, it is not a film nor the line where surface and wall meet.

  HWY_INLINE Pair pair(const Record& own, const std::uint32_t* index) const {
    const Quad place = load_transposed(F(), base_, index, 8);
    Pair r;
    r.x = distances_.metres(own.x, place.a, distances_.qx);
    r.z = distances_.metres(own.z, place.c, distances_.qz);
    r.r2 = hn::MulAdd(r.z, r.z, hn::Mul(r.x, r.x));
    if constexpr (Dim == 3) {
      r.y = distances_.metres(own.y, place.b, distances_.qy);
      r.r2 = hn::MulAdd(r.y, r.y, r.r2);
    } else {
      r.y = hn::Zero(F());
    }
    r.p = place.d;
    r.slope = kernel_.slope(r.r2);
    return r;
  }

  /// q = rho (alpha c u + u^2), u the speed of approach: zero for pairs that part. The linear part between particles
  /// only, and with a sample u is at most the speed against its surface: along walls and bodies both would drag at a
  /// flow without friction (measured: README.md).
  HWY_INLINE VF dissipation(std::uint32_t item, const Pair& r, const Quad& motion, VF rho,
                            const std::uint32_t* index) const {
    const F d;
    const Record& own = items_.record[item];
    const VF zero = hn::Zero(d);
    const VF vx = hn::Sub(hn::Set(d, own.vx), motion.a), vy = hn::Sub(hn::Set(d, own.vy), motion.b);
    const VF vz = hn::Sub(hn::Set(d, own.vz), motion.c);
    const auto speed_along = [&](VF x, VF y, VF z) HWY_ATTR {
      VF dot = hn::MulAdd(vx, x, hn::Mul(vz, z));
      if constexpr (Dim == 3) dot = hn::MulAdd(vy, y, dot);
      return dot;
    };
    const VF length = hn::Sqrt(hn::Max(r.r2, hn::Set(d, 1e-30f)));
    const VF u = hn::Max(hn::Neg(hn::Div(speed_along(r.x, r.y, r.z), length)), zero);
    const auto ram = [&](VF against) HWY_ATTR {
      const VF speed = hn::Max(hn::Min(u, against), zero);
      return hn::Mul(rho, hn::Mul(speed, speed));
    };
    if (own.volume < 0) {
      if (!constants_.ram_on_samples) return zero;
      const NormalRecord& n = extras_.normal[item];
      return ram(speed_along(hn::Set(d, n.x), hn::Set(d, n.y), hn::Set(d, n.z)));
    }
    const auto sample = hn::Lt(motion.d, zero);
    const VF linear = hn::Set(d, constants_.artificial_viscosity * constants_.sound_speed);
    const VF q = hn::Mul(hn::Mul(rho, u), hn::Add(linear, u));
    if (hn::AllFalse(d, sample)) return q;
    if (!constants_.ram_on_samples) return hn::IfThenZeroElse(sample, q);
    const Quad n = load_transposed(d, &extras_.normal[0].x, index, 4);
    return hn::IfThenElse(sample, ram(hn::Neg(speed_along(n.a, n.b, n.c))), q);
  }

  float density(std::uint32_t item) const {
    return constants_.several_densities ? extras_.density[item] : extras_.density.empty() ? 1.f : extras_.density[0];
  }
  /// Mean density of a pair; of a pair with a sample the particle's own, as the sample sees it.
  HWY_INLINE VF pair_density(VF own, const Quad& motion, const std::uint32_t* index) const {
    const F d;
    const VF mean = hn::Mul(hn::Set(d, 0.5f), hn::Add(own, densities(index)));
    return hn::IfThenElse(hn::Lt(motion.d, hn::Zero(d)), own, mean);
  }

  const Neighbourhood& items_;
  const ItemExtras& extras_;
  const PassConstants& constants_;
  VectorKernel<K> kernel_;
  Distances distances_;
  const float* base_;
};

}  // namespace HWY_NAMESPACE
}  // namespace ballast::fluid
HWY_AFTER_NAMESPACE();
#endif
