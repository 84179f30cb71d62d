// How the pressure of each particle near a free body pushes it: the bodies' part of the pressure system,
// dt^2 W K W^T with W the wrenches per unit pressure and K the mobility, kept as U U^T with U = dt W sqrt(K).
#pragma once
#include <Eigen/SparseCholesky>
#include <span>
#include <utility>
#include <vector>

#include "common/exchange/records.h"
#include "fluid_server/boundary/samples.h"
#include "fluid_server/passes/passes.h"

namespace ballast::fluid {

class BodyRows {
 public:
  BodyRows() = default;
  BodyRows(const BodyRows&) = delete;  // rows are pointed at
  BodyRows& operator=(const BodyRows&) = delete;
  /// Gathers the rows. Bodies without mobility have none. `sums` as from gather_samples, `inverse_w` by which a
  /// sample weighs the pressures that it extrapolates, per sample; `pairs` from sum_rows.
  void build(const Neighbourhood& items, const Samples& samples, std::span<const exchange::BodyState> states,
             const std::vector<SampleSums>& sums, const std::vector<float>& inverse_w, const KeptPairs& pairs,
             const PassConstants& constants, double dt);
  bool empty() const { return count_ == 0; }
  bool moves(std::size_t body) const { return !rows_[body].empty(); }

  /// y_b = sum_i U_ib x_i, for each body.
  void reduce(std::span<const float> x, std::vector<Vector6>& y) const;
  /// out_i += sum_b U_ib . y_b.
  void spread(std::span<const Vector6> y, std::span<float> out) const;
  /// out_i -= sum_b U_ib . y_b / diagonal_i.
  void spread_scaled(std::span<const Vector6> y, std::span<const float> diagonal, std::span<float> out) const;
  /// sqrt(K) y: with y = reduce(p), dt times the body's acceleration by these pressures.
  Vector6 motion(std::size_t body, const Vector6& y) const { return root_[body] * y; }
  /// Largest eigenvalue that the bodies add to the system scaled by its diagonal (an upper bound).
  double norm() const { return norm_; }
  /// True if a uniform pressure moves a body: one that is not surrounded, but closes off the water as a piston does.
  bool has_piston() const;
  /// Prepares T = 1 + U^T D^-1 U for solve().
  void factor(std::span<const float> diagonal);
  void solve(std::vector<Vector6>& y) const;  ///< y = T^-1 y
  std::size_t memory() const;

 private:
  struct Row {
    std::uint32_t particle, body;
    float u[6];
  };
  /// add(particle, U_ib . y_b) for every row.
  template <class Add>
  void for_each_row(std::span<const Vector6> y, Add&& add) const;
  void find_wet(const Neighbourhood& items, const Samples& samples, const std::vector<SampleSums>& sums);
  void add_rows(const Neighbourhood& items, const Samples& samples, const exchange::BodyState& state,
                std::uint32_t body, const std::vector<SampleSums>& sums, const std::vector<float>& inverse_w,
                const KeptPairs& pairs, const PassConstants& constants, std::vector<std::uint32_t>& row_of,
                std::vector<Row>& out) const;
  void index_particles(std::size_t particles);

  int threads_ = 1;
  std::vector<std::vector<Row>> rows_;              // of each body, by particle
  std::uint32_t count_ = 0;                         // of all rows
  std::vector<const Row*> by_particle_;             // by particle, of each by body
  std::vector<std::uint32_t> particle_start_;       // in by_particle_: of each particle that has a row, and the end
  std::vector<Matrix6> root_;                       // sqrt of the mobility, per body; zero without
  std::vector<std::uint32_t> wet_, first_wet_;      // indices into the sums of wet samples, by body
  std::vector<std::vector<std::uint32_t>> row_of_;  // by thread: row of each particle in the body at hand
  std::vector<std::uint32_t> slot_;                 // of each body among those with rows, ~0u without
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
  struct Shared {
    std::uint32_t slot;  // of the second of two bodies at the same particles
    Matrix6 block;
  };
  std::vector<std::vector<Shared>> shared_;  // by slot of the first
  using Slots = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Slots> touching_;  // bodies at the same particles when the factor's pattern was analysed, after its size
  double norm_ = 0;
};

}  // namespace ballast::fluid
