// The incompressible pressure solve: one bound-constrained system for density and divergence with the free bodies
// inside,
//   A p >= b, p >= 0, complementary,  A = dt^2 (G^T M^-1 G + W K W^T) + V / (rho c^2),  b = V beta e - dt (G^T v* + W^T
//   u*).
// e is the compression that is left, v* and u* what particles and bodies would do without pressure. README.md derives
// it.
#pragma once
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "fluid_server/boundary/response.h"
#include "fluid_server/particles/particles.h"
#include "fluid_server/pressure/body_rows.h"
#include "fluid_server/pressure/mprgp.h"

namespace ballast::fluid {

/// What one step asks of the solver.
struct ImplicitOptions {
  double tolerance = 1e-5;       ///< mean density error left by a step
  double body_tolerance = 1e-3;  ///< change of a body's acceleration over `body_products`, of max(|a|, reference)
  std::size_t body_products = 5;
  double way = 0;            ///< that the fastest particles have gone past others since the start, spacings
  double weight = 0;         ///< |G| of the world, m/s^2, which bodies feel where the fluid does not (reduced gravity)
  int most_products = 2000;  ///< beyond which a step is counted as unreached
  std::function<void()> sign_of_life = [] {};  ///< called in every product: of many particles a solve takes minutes
};

/// Sums over the run, for the record.
struct ImplicitReport {
  std::uint64_t solves = 0, products = 0, most = 0, expansions = 0, refused = 0, unreached = 0;
  double residual = 0;        ///< mean density error left by the last solve
  double found_mean = 0;      ///< compression that the last step began with, mean over particles
  double found_max = 0;       ///< and largest
  double worst_residual = 0;  ///< of all
  double seconds = 0;         ///< inside the solver
  int release_rounds = 0;     ///< until the pressure at release had settled; 0: the fluid was in motion
  double release_change = 0;  ///< of that pressure in the last round, of the largest
};

class ImplicitPressure : private QuadraticProgram {
 public:
  ImplicitPressure(const Samples& samples, const Kernel& kernel, double spacing)
      : samples_(samples), spacing_(spacing), lattice_density_(static_cast<float>(lattice_density(kernel, spacing))) {}

  /// Lists are built; `sums`, `acceleration` and the samples' pressures are scratch. Finds the pressure of every
  /// particle into its record and its item's, and advances `particles.compression`. The caller then lets `response`
  /// work as for any pressure.
  void solve(Particles& particles, Neighbourhood& items, ItemExtras& extras, const PassConstants& constants,
             std::span<const exchange::BodyState> states, Response& response, std::vector<SampleSums>& sums,
             std::vector<float>& acceleration, const ImplicitOptions& options);

  /// By what a sample's share of the particles' pressure is scaled, into the sums of gather_samples: for the forces of
  /// the pressure that was found, which the solve itself has scaled.
  void scale(std::vector<SampleSums>& sums) const;

  const ImplicitReport& report() const { return report_; }
  /// The start of the next solve is in the particles; the norm is estimated once in a run.
  template <class A>
  void state(A& a) {
    a("report", report_), a("norm", fluid_norm_), a("start_disorder", start_disorder_);
  }
  std::size_t memory() const;

 private:
  void multiply(std::span<const float> x, std::vector<float>& out) override;
  void precondition(std::span<const float> r, std::vector<float>& out) override;
  bool good(std::span<const float> x, std::span<const float> gradient) override;
  bool harmless(std::span<const float> cut) override;
  bool negligible(double beyond) const override { return beyond <= kNegligible * options_.tolerance * volume_; }

  void set_up(const Particles& particles, std::span<const exchange::BodyState> states, const Response& response,
              const std::vector<SampleSums>& sums);
  static bool untouched(const Particles& particles);
  void follow_films(std::span<const exchange::BodyState> states, Response& response, std::vector<SampleSums>& sums);
  void release(Particles& particles, std::span<const exchange::BodyState> states, Response& response,
               std::vector<SampleSums>& sums);
  void without_pressure(std::span<const exchange::BodyState> states, Response& response, std::vector<SampleSums>& sums);
  MprgpReport find_pressure(const Particles& particles);
  float source_of(float compression) const;
  float softness(std::size_t f) const;
  void find_shares();
  void hold_squeezed();
  void balance_closed(const Particles& particles);
  void correct_compression(Particles& particles, bool first);
  void add_second_order(const Particles& particles, std::span<const float> invariant);
  void predict(std::span<const exchange::BodyState> states, const Response& response);
  void estimate_norm();
  double slowest_wave(const Particles& particles) const;
  void foresee(std::span<const float> x, std::span<const float> gradient);
  double allowed(std::size_t body) const;
  bool correct_bodies();

  const Samples& samples_;
  double spacing_;
  float lattice_density_;
  // of the solve at hand
  Particles* particles_ = nullptr;
  Neighbourhood* items_ = nullptr;
  ItemExtras* extras_ = nullptr;
  const PassConstants* constants_ = nullptr;
  std::vector<float>* acceleration_ = nullptr;  // of the particles without pressure
  ImplicitOptions options_;
  double dt_ = 0, reference_ = 0;  // acceleration that a change of a body's is compared with
  bool weighs_ = false;            // the fluid has gravity
  bool at_release_ = false;        // accelerations count, velocities do not
  float pace_ = 1;                 // share of its correction that a step of this length makes

  Mprgp mprgp_;
  BodyRows bodies_;
  std::vector<RowSums> rows_;
  KeptPairs pairs_;
  double uniform_ = 0;         // weight of a uniform pressure: balance_closed
  std::vector<float> share_;   // find_shares
  std::vector<float> source_;  // compression that a step takes back
  struct Held {                // hold_squeezed
    std::uint32_t particle;
    float right;  // of its row
  };
  std::vector<Held> held_;
  std::vector<float> inverse_w_, yielding_, diagonal_, right_, pressure_, divergence_;
  std::vector<std::uint8_t> bounded_;
  std::vector<Flow> flow_;
  std::vector<float> scaled_;
  std::vector<Vector6> reduced_, foreseen_, start_;
  std::vector<Vector6> correction_, gained_;  // foresee
  bool reached_ = false;                      // the tolerance of the density, by an iterate of this solve
  bool foreseen_now_ = false;                 // with the last pressures tested
  std::deque<std::vector<Vector6>> history_;  // accelerations of the bodies, one entry a test
  std::vector<float> last_;                   // release
  std::span<const float> left_;               // the right side that the last solve has not met
  static constexpr float kInside = 0.8f;      // fullness of the inside
  static constexpr float kShut = 0.1f;        // room of a gap that is taken to be shut
  static constexpr double kNegligible = 0.1;  // of the error that a step may leave
  float start_disorder_ = 0;                  // deviation of the summed density that the start shows
  double fluid_norm_ = 0, volume_ = 0, mean_diagonal_ = 0;
  ImplicitReport report_;
};

}  // namespace ballast::fluid
