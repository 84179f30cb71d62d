// The bodies' part of the pressure system.
#include "fluid_server/pressure/body_rows.h"

#include <Eigen/Dense>
#include <cmath>
#include <map>

#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

constexpr std::uint32_t kNone = ~0u;

/// Symmetric square root of a positive semidefinite matrix.
Matrix6 root_of(const Matrix6& m) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(0.5 * (m + m.transpose()));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace

void BodyRows::build(const Neighbourhood& items, const Samples& samples, std::span<const exchange::BodyState> states,
                     const std::vector<SampleSums>& sums, const std::vector<float>& inverse_w,
                     const PassConstants& constants, double dt) {
  threads_ = constants.threads;
  root_.assign(states.size(), Matrix6::Zero());
  free_.assign(states.size(), 0);
  for (std::size_t b = 0; b < states.size(); ++b) {
    const auto mobility = mobility_of(states[b]);
    if (mobility.isZero(0)) continue;
    free_[b] = 1;
    root_[b] = root_of(mobility);
  }
  sum_of_sample_.assign(items.size(), kNone);
  arm_.resize(sums.size());
  for (std::uint32_t s = 0; s < sums.size(); ++s) {
    const std::uint32_t item = items.sample_item[s], sample = items.source[item] & ~Neighbourhood::kSample;
    const std::uint32_t body = samples.body[sample];
    if (!free_[body] || !(sums[s].w > 0)) continue;
    sum_of_sample_[item] = s;
    const exchange::BodyState& state = states[body];
    const Quat q = rotation_of(state);
    arm_[s] = (q * samples.local[sample].cast<double>()).cast<float>();
  }
  const std::size_t particles = items.fluid_item.size(), blocks = (particles + kSumBlock - 1) / kSumBlock;
  std::vector<std::vector<Row>> part(blocks);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 1)
  for (std::size_t block = 0; block < blocks; ++block)
    add_rows(items, samples, sums, inverse_w, constants, static_cast<std::uint32_t>(block * kSumBlock),
             static_cast<std::uint32_t>(std::min(particles, (block + 1) * kSumBlock)), part[block]);
  row_.clear();
  for (const auto& some : part) row_.insert(row_.end(), some.begin(), some.end());
  for (Row& row : row_) {
    Vector6 wrench;
    for (int k = 0; k < 6; ++k) wrench[k] = row.u[k];
    const Vector6 u = dt * (root_[row.body] * wrench);
    for (int k = 0; k < 6; ++k) row.u[k] = static_cast<float>(u[k]);
  }
  particle_start_.clear();
  first_.assign(states.size() + 1, 0);
  for (std::uint32_t r = 0; r < row_.size(); ++r) {
    if (r == 0 || row_[r].particle != row_[r - 1].particle) particle_start_.push_back(r);
    ++first_[row_[r].body + 1];
  }
  particle_start_.push_back(static_cast<std::uint32_t>(row_.size()));
  for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
  by_body_.resize(row_.size());
  std::vector<std::uint32_t> cursor(first_.begin(), first_.end() - 1);
  for (std::uint32_t r = 0; r < row_.size(); ++r) by_body_[cursor[row_[r].body]++] = r;
}

/// A unit of pressure in particle i pushes sample s by -V_s V_i g (x_s - x_i) directly, and through what the sample
/// extrapolates, V_i W / sum V W, by that share of the sample's area -V_s sum V_k g (x_s - x_k).
void BodyRows::add_rows(const Neighbourhood& items, const Samples& samples, const std::vector<SampleSums>& sums,
                        const std::vector<float>& inverse_w, const PassConstants& constants, std::uint32_t begin,
                        std::uint32_t end, std::vector<Row>& out) const {
  const Coordinates& coordinates = items.coordinates();
  const Eigen::Vector3f quantum = coordinates.quantum.cast<float>();
  for (std::uint32_t f = begin; f < end; ++f) {
    const std::uint32_t item = items.fluid_item[f];
    const Record& own = items.record[item];
    const std::uint32_t* list = items.lists.of(item);
    const std::size_t mine = out.size();
    for (std::uint32_t k = 0; k < items.lists.count[item]; ++k) {
      const std::uint32_t s = sum_of_sample_[list[k]];
      if (s == kNone) continue;
      const Record& other = items.record[list[k]];
      Eigen::Vector3f r(static_cast<float>(static_cast<std::int32_t>(other.x - own.x)) * quantum[0],
                        static_cast<float>(static_cast<std::int32_t>(other.y - own.y)) * quantum[1],
                        static_cast<float>(static_cast<std::int32_t>(other.z - own.z)) * quantum[2]);
      if (constants.kernel.dimension == 2) r[1] = 0;
      const double distance = r.norm();
      const float volume = -other.volume, slope = static_cast<float>(constants.kernel.slope_over_r(distance));
      const float share = own.volume * static_cast<float>(constants.kernel.value(distance)) * inverse_w[s];
      const Eigen::Vector3f push = -volume * (own.volume * slope * r + share * Eigen::Vector3f::Map(sums[s].g));
      const Eigen::Vector3f turn = arm_[s].cross(push);
      const std::uint32_t body = samples.body[items.source[list[k]] & ~Neighbourhood::kSample];
      std::size_t at = mine;
      while (at < out.size() && out[at].body != body) ++at;
      if (at == out.size()) out.push_back({f, body, {}});
      for (int c = 0; c < 3; ++c) out[at].u[c] += push[c], out[at].u[3 + c] += turn[c];
    }
  }
}

void BodyRows::reduce(std::span<const float> x, std::vector<Vector6>& y) const {
  y.resize(root_.size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 4) if (row_.size() > kSerial)
  for (std::size_t b = 0; b < root_.size(); ++b) {
    y[b].setZero();
    for (std::uint32_t k = first_[b]; k < first_[b + 1]; ++k) {
      const Row& row = row_[by_body_[k]];
      const double value = x[row.particle];
      for (int c = 0; c < 6; ++c) y[b][c] += value * row.u[c];
    }
  }
}

template <class Add>
void BodyRows::for_each_row(std::span<const Vector6> y, Add&& add) const {
  const std::size_t count = particle_start_.size() - 1;
#pragma omp parallel for num_threads(threads_) schedule(static) if (row_.size() > kSerial)
  for (std::size_t p = 0; p < count; ++p)
    for (std::uint32_t r = particle_start_[p]; r < particle_start_[p + 1]; ++r) {
      double sum = 0;
      for (int c = 0; c < 6; ++c) sum += row_[r].u[c] * y[row_[r].body][c];
      add(row_[r].particle, static_cast<float>(sum));
    }
}

void BodyRows::spread(std::span<const Vector6> y, std::span<float> out) const {
  for_each_row(y, [&](std::uint32_t particle, float value) { out[particle] += value; });
}

void BodyRows::spread_scaled(std::span<const Vector6> y, std::span<const float> diagonal, std::span<float> out) const {
  for_each_row(y, [&](std::uint32_t particle, float value) { out[particle] -= value / diagonal[particle]; });
}

void BodyRows::factor(std::span<const float> diagonal) {
  slot_.assign(root_.size(), kNone);
  unknowns_ = 0;
  for (std::size_t b = 0; b < root_.size(); ++b)
    if (moves(b)) slot_[b] = static_cast<std::uint32_t>(unknowns_), unknowns_ += 6;
  if (unknowns_ == 0) return;
  std::map<std::pair<std::uint32_t, std::uint32_t>, Matrix6> blocks;
  for (std::size_t p = 0; p + 1 < particle_start_.size(); ++p) {
    const double weight = 1.0 / diagonal[row_[particle_start_[p]].particle];
    for (std::uint32_t r = particle_start_[p]; r < particle_start_[p + 1]; ++r)
      for (std::uint32_t s = particle_start_[p]; s < particle_start_[p + 1]; ++s) {
        const std::uint32_t a = slot_[row_[r].body], c = slot_[row_[s].body];
        if (a < c) continue;  // the lower half is enough
        const Vector6 u = Eigen::Map<const Eigen::Matrix<float, 6, 1>>(row_[r].u).cast<double>();
        const Vector6 v = Eigen::Map<const Eigen::Matrix<float, 6, 1>>(row_[s].u).cast<double>();
        auto [entry, created] = blocks.try_emplace({a, c}, Matrix6::Zero());
        entry->second.noalias() += weight * u * v.transpose();
      }
  }
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> trace(unknowns_ / 6, 0.0);
  for (const auto& [at, block] : blocks) {
    if (at.first == at.second) trace[at.first / 6] += block.trace();
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j)
        entries.emplace_back(static_cast<int>(at.first) + i, static_cast<int>(at.second) + j,
                             block(i, j) + (at.first == at.second && i == j ? 1.0 : 0.0));
  }
  // Blocks of bodies that share particles add up; more than two bodies at one particle are taken to be rare.
  norm_ = 2 * *std::max_element(trace.begin(), trace.end());
  Eigen::SparseMatrix<double> matrix(static_cast<int>(unknowns_), static_cast<int>(unknowns_));
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(matrix);
}

void BodyRows::solve(std::vector<Vector6>& y) const {
  Eigen::VectorXd packed(static_cast<int>(unknowns_));
  for (std::size_t b = 0; b < y.size(); ++b)
    if (slot_[b] != kNone) packed.segment<6>(slot_[b]) = y[b];
  packed = factor_.solve(packed).eval();
  for (std::size_t b = 0; b < y.size(); ++b)
    if (slot_[b] != kNone) y[b] = packed.segment<6>(slot_[b]);
}

std::size_t BodyRows::memory() const {
  return row_.capacity() * sizeof(Row) + (by_body_.capacity() + first_.capacity() + particle_start_.capacity()) * 4 +
         sum_of_sample_.capacity() * 4 + arm_.capacity() * sizeof(Eigen::Vector3f) + root_.capacity() * sizeof(Matrix6);
}

}  // namespace ballast::fluid
