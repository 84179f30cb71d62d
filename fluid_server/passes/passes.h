// The passes over pairs: everything that costs time. Vector code for every instruction set in one binary (Highway).
// Symbols: r = x_i - x_j, g = W'(r)/r, so grad_i W_ij = g r; V rest volume, p pressure, v velocity, rho rest density.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "fluid_server/kernel.h"
#include "fluid_server/neighbours/neighbourhood.h"
#include "fluid_server/neighbours/resize.h"

namespace ballast::fluid {

/// What all passes of a step share.
struct PassConstants {
  Kernel kernel;
  float sound_speed = 0;           ///< c, m/s
  float diffusion = 0;             ///< xi of the delta-SPH term (Molteni and Colagrossi 2009), no unit
  float artificial_viscosity = 0;  ///< alpha of Monaghan (1992), no unit
  float gravity[3] = {0, 0, 0};    ///< m/s^2
  float dt = 0;                    ///< s
  bool ram_on_samples = false;     ///< the ram pressure of encounters acts between particles and samples too
  bool viscous = false;            ///< some fluid has viscosity: `wall` is filled
  bool several_densities = false;  ///< `density` is filled per item; else density[0] holds for all
  int threads = 1;
};

/// Per item, only where needed: velocity that the viscous term sees, and viscosity (Pa s; negative: a sample, which
/// takes on its neighbour's).
struct ViscousRecord {
  float wx, wy, wz, mu;
};

/// What the viscous sum lacks around a particle. Its pairs give a field's second derivatives exactly where
/// D = 1 + sum V_j g r r is 0, as on the lattice; where the flow has sheared the lattice by a fifth to four fifths,
/// 0.2 % is missing. So a pair along e is weighted by 1 + e.C.e, C the mean of both particles' (a sample takes on its
/// neighbour's), with which the second moments are right to the order of D^2: C = ((n + 2) D - tr D) / 2 in n
/// dimensions, from the fourth moments of an isotropic kernel. At surfaces, where |D| is above kMost, C fades to 0 at
/// twice that. Mixed terms are stored doubled; samples have none.
struct Evening {
  static constexpr float kMost = 0.1f;
  float xx, zz, zx, yy, xy, yz, unused[2];
};

/// Outward unit normal of a sample's surface, in the world.
struct NormalRecord {
  float x, y, z, unused;
};

/// Fields beside the records that some scenes need.
struct ItemExtras {
  std::vector<NormalRecord> normal;    ///< per item, set for samples, if PassConstants::ram_on_samples
  std::vector<ViscousRecord> viscous;  ///< per item if PassConstants::viscous
  std::vector<Evening> evening;        ///< per item if PassConstants::viscous
  std::vector<float> density;          ///< rest density per item (samples: any), or one value
  float density_of(std::uint32_t item) const { return density.size() == 1 ? density[0] : density[item]; }
};

/// Sums of one wet boundary sample over its fluid neighbours k.
struct SampleSums {
  float w;        ///< sum V_k W
  float wp;       ///< sum V_k W p_k
  float wr[3];    ///< sum V_k W rho_k (x_b - x_k)
  float g[3];     ///< sum V_k g (x_b - x_k)
  float pg[3];    ///< sum V_k (p_k + q_k) g (x_b - x_k), q the dissipation of approaching pairs
  float nearest;  ///< distance to the nearest neighbour, m; 0 if dry
  float share;    ///< by which the pressure that the sample extrapolates is scaled: 1, less where the solver says so
};

/// The same for viscous fluids; mu' = mu (1 + e.C.e).
struct ViscousSums {
  float wv[3];  ///< sum V_k W v_k
  float wd[3];  ///< sum V_k W (x_b - x_k)
  float a;      ///< sum V_k 2 mu' g
  float ar[3];  ///< sum V_k 2 mu' g (x_b - x_k)
  float av[3];  ///< sum V_k 2 mu' g v_k
};

/// Builds the lists of all items (samples: fluid neighbours only) and, in the same sweep, advances the pressure of
/// every particle by continuity and density diffusion over dt: `new_pressure`, per particle.
///   dp_i/dt = rho c^2 sum V_j (v_i - v_j).g r - 2 xi h c sum_fluid V_j (p_j - p_i + rho G.r) g
/// In spray, where -sum V_j r.g r falls below half of the dimension, or the fluid's part of it below a fifth of what
/// solids leave, tension is let go: p >= 0. Beside air (below 0.9 of the dimension) solids that move away lower p at
/// most to 0, and not at all where the fluid's part is above 0.6 of the dimension.
void build_lists_and_advance_pressure(Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                                      std::vector<float>& new_pressure);

/// The same from lists that are there.
void advance_pressure(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                      std::vector<float>& new_pressure);

/// Only the lists.
void build_lists(Neighbourhood& items, const PassConstants& constants);

/// Sums of every sample item, in the order of items.sample_item.
void gather_samples(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    std::vector<SampleSums>& sums);

void gather_viscous(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    std::vector<ViscousSums>& sums);

/// C of every particle, at its item.
void find_evening(const Neighbourhood& items, const PassConstants& constants, std::vector<Evening>& out);

/// Acceleration of every particle, m/s^2, x y z in turn:
///   a_i = G - 1/rho_i sum V_j (p_i + p_j + q_ij) g r + 1/rho_i sum V_j (mu_i + mu_j) (1 + e.C.e) g (v_i - w_j)
/// q_ij = rho (alpha c u + u^2) for pairs that approach with speed u: artificial viscosity (Monaghan 1992), its linear
/// part between particles only, and the ram pressure of the encounter (von Neumann and Richtmyer 1950), second order in
/// the spacing where the flow is smooth; with samples only where the constants say so.
/// first() is called by one of the threads before it takes part, while the others begin.
void accelerate(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                std::vector<float>& acceleration, const std::function<void()>& first = {});

/// The same for some particles, in their order.
void accelerate_some(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                     std::span<const std::uint32_t> particles, std::vector<float>& acceleration);

/// Summed density sum V_j W (self included) and its gradient sum V_j g r of every particle, x y z in turn; samples
/// count.
void sum_density(const Neighbourhood& items, const PassConstants& constants, std::vector<float>& delta,
                 std::vector<float>& gradient);

/// How uneven the distances around a particle are.
struct Unevenness {
  float push[3];   ///< -sum V_j (1 + (W / W(d))^4 / 5) g r, towards even ones, 1/m; against pairs: Monaghan (2000)
  float dense[3];  ///< sum V_j g r, counted twice where j is a particle, 1/m
  float speed;     ///< largest of a neighbour (a particle) against it, m/s
  float fullness;  ///< -sum V_j g r^2 over the dimension: 1 inside, less at a surface
  float solid;     ///< the part of it that samples make
  float share;     ///< of its push that the particle may follow; set later
};
void find_unevenness(const Neighbourhood& items, const PassConstants& constants, double spacing,
                     std::vector<Unevenness>& out);

// --- the implicit solver's passes. With G the map from pressures to the forces -V_i sum V_j (p_i + p_j) g r on the
// particles, samples carrying the extrapolated p_b = sum_k e_bk p_k, e_bk = V_k W / sum V W, the divergence is its
// transpose: every sample hands its own flux back to the particles that it took its pressure from (pressure/README.md).

/// What a particle's neighbourhood says about its row of the pressure system.
struct RowSums {
  float delta;     ///< sum V_j W, self included; samples count
  float fullness;  ///< fluid's share of the room that solids leave, by -sum V_j g r^2: 1 inside, less at a surface
  float square;    ///< sum over fluid neighbours of V_j g^2 r^2 / rho_j
  float room;      ///< share of its surroundings that solids leave, by the same sum
};

/// Velocity or acceleration per item beside its record, so that a pass can write one and read the other.
struct Flow {
  float x, y, z, volume;  ///< volume as in Record
};

/// What is kept of the pairs for the products of one solve, list after list in the order of the items, and as many
/// numbers as a list takes in whole vectors: the slope of every pair, from which r, out of positions in 16 bytes with
/// the pressure, makes the gradient again; kernel values only where samples take part.
struct KeptPairs {
  struct Sum {
    float x, y, z;          ///< sum V_j g r
    float touches_samples;  ///< 0: no sample among the neighbours
  };
  struct Point {
    std::uint32_t x, y, z;  ///< as in Record
    float p;                ///< what the product at hand reads
  };
  struct Active {
    std::uint32_t item;
    float inverse_w;
  };
  std::vector<float> slope;                  ///< V_j g
  std::vector<float> value;                  ///< particle: W where the neighbour is a sample, else 0; sample: V_k W
  std::vector<std::uint32_t> slopes_before;  ///< per item: vectors of slopes before those of its list
  std::vector<std::uint32_t>
      values_before;           ///< per item: the same of values, for samples and particles that touch them
  std::vector<Sum> sum;        ///< per particle
  std::vector<Point> point;    ///< per item
  std::vector<Active> active;  ///< the samples that extrapolate
  std::vector<std::uint32_t> active_shares;  ///< of these
  std::uint32_t lanes = 1;                   ///< of a vector
  /// What is kept of an item's list, in its order.
  float* slopes_of(std::uint32_t item) { return slope.data() + std::size_t{slopes_before[item]} * lanes; }
  float* values_of(std::uint32_t item) { return value.data() + std::size_t{values_before[item]} * lanes; }
  const float* slopes_of(std::uint32_t item) const { return slope.data() + std::size_t{slopes_before[item]} * lanes; }
  const float* values_of(std::uint32_t item) const { return value.data() + std::size_t{values_before[item]} * lanes; }
  /// Room for the slopes of all lists of these items, in vectors of `in_vector`; for their values, once `sum` is known.
  void make_room_for_slopes(const Neighbourhood& items, std::uint32_t in_vector, int threads);
  void make_room_for_values(const Neighbourhood& items, int threads);
  std::size_t memory() const;  ///< bytes of all its arrays
};

/// Row sums of every particle, and what is kept of all pairs.
void sum_rows(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
              std::vector<RowSums>& sums, KeptPairs& pairs);

/// out = mean over each sample's particles of x, weighted by V W; 0 where dry.
void average_onto_samples(const Neighbourhood& items, const PassConstants& constants, KeptPairs& pairs,
                          std::span<const float> x, std::vector<float>& out);

/// How much each sample extrapolates in the products to come: `inverse_w` is what it multiplies sum V W p by, 1 / sum V
/// W or less, 0 where dry. `pairs` from sum_rows of the same lists; the samples' `flow` becomes that of rest.
void weigh_samples(const Neighbourhood& items, std::span<const float> inverse_w, int threads, KeptPairs& pairs,
                   std::vector<Flow>& flow);

/// out = diagonal of G^T M^-1 G, per particle, without what a sample hands on to others; `pairs` from weigh_samples.
void find_diagonal(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                   const std::vector<RowSums>& sums, KeptPairs& pairs, std::vector<float>& out);

/// out = G^T M^-1 G x, per particle; solids at rest. `pairs` and `flow` from weigh_samples; leaves the particles'
/// accelerations M^-1 G x in `flow`.
void apply_pressure(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                    KeptPairs& pairs, std::span<const float> x, std::vector<Flow>& flow, std::vector<float>& out);

/// out = G^T v for the velocities in `flow`, those of the samples included: volume times divergence, per particle.
/// invariant = Q, 1/s^2, the second invariant of the velocity gradient (negative where strain rules, positive where
/// rotation does): -tr(L L) / 2 with L = sum V_j (v_j - v_i) g r over particles alone, over their part of the
/// surroundings (-sum V_j g r^2 / dimension), less a third (2-D: half) of its trace on the diagonal.
void apply_divergence(Neighbourhood& items, const PassConstants& constants, const std::vector<float>& inverse_w,
                      const std::vector<Flow>& flow, std::vector<float>& out, std::vector<float>& invariant);

/// Name of the instruction set in use, for the record.
const char* simd_name();

}  // namespace ballast::fluid
