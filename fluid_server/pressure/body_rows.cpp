// The bodies' part of the pressure system.
#include "fluid_server/pressure/body_rows.h"

#include <omp.h>

#include <Eigen/Dense>
#include <algorithm>

#include "fluid_server/neighbours/shares.h"
#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

constexpr std::uint32_t kNone = ~0u;
constexpr std::size_t kFewBodies = 8;  // below this a second thread costs more than it brings

/// Symmetric square root of a positive semidefinite matrix.
Matrix6 root_of(const Matrix6& m) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(0.5 * (m + m.transpose()));
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

Vector6 wide(const float (&u)[6]) { return Eigen::Map<const Eigen::Matrix<float, 6, 1>>(u).cast<double>(); }

}  // namespace

void BodyRows::build(const Neighbourhood& items, const Samples& samples, std::span<const exchange::BodyState> states,
                     const std::vector<SampleSums>& sums, const std::vector<float>& inverse_w, const KeptPairs& pairs,
                     const PassConstants& constants, double dt) {
  threads_ = constants.threads;
  const auto moves_freely = [](const exchange::BodyState& state) { return !mobility_of(state).isZero(0); };
  count_ = 0;
  root_.assign(states.size(), Matrix6::Zero());
  rows_.resize(states.size());
  for (std::vector<Row>& rows : rows_) rows.clear();
  if (std::none_of(states.begin(), states.end(), moves_freely)) return;
#pragma omp parallel for num_threads(threads_) schedule(static) if (states.size() > kFewBodies)
  for (std::size_t b = 0; b < states.size(); ++b)
    if (moves_freely(states[b])) root_[b] = root_of(mobility_of(states[b]));
  find_wet(items, samples, sums);
  row_of_.resize(static_cast<std::size_t>(threads_));
  for_each_by_turns(states.size(), threads_, [&](std::size_t b) {
    std::vector<std::uint32_t>& row_of = row_of_[static_cast<std::size_t>(omp_get_thread_num())];
    row_of.resize(items.fluid_item.size(), kNone);
    std::vector<Row>& rows = rows_[b];
    add_rows(items, samples, states[b], static_cast<std::uint32_t>(b), sums, inverse_w, pairs, constants, row_of, rows);
    for (Row& row : rows) {
      row_of[row.particle] = kNone;
      const Vector6 u = dt * (root_[b] * wide(row.u));
      Eigen::Map<Eigen::Matrix<float, 6, 1>>(row.u) = u.cast<float>();
    }
    std::ranges::sort(rows, {}, &Row::particle);
  });
  index_particles(items.fluid_item.size());
}

/// Wet samples of the bodies that have mobility.
void BodyRows::find_wet(const Neighbourhood& items, const Samples& samples, const std::vector<SampleSums>& sums) {
  using Wet = std::pair<std::uint32_t, std::uint32_t>;  // body, index into sums
  std::vector<std::vector<Wet>> found((sums.size() + kSumBlock - 1) / kSumBlock);
  for_blocks(sums.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      if (!(sums[s].w > 0)) continue;
      const std::uint32_t sample = items.source[items.sample_item[s]] & ~Neighbourhood::kSample;
      if (sample < samples.first_moving || root_[samples.body[sample]].isZero(0)) continue;
      found[begin / kSumBlock].emplace_back(samples.body[sample], static_cast<std::uint32_t>(s));
    }
  });
  first_wet_.assign(root_.size() + 1, 0);
  for (const std::vector<Wet>& block : found)
    for (const Wet& wet : block) ++first_wet_[wet.first + 1];
  for (std::size_t b = 1; b < first_wet_.size(); ++b) first_wet_[b] += first_wet_[b - 1];
  wet_.resize(first_wet_.back());
  std::vector<std::uint32_t> cursor(first_wet_.begin(), first_wet_.end() - 1);
  for (const std::vector<Wet>& block : found)
    for (const auto& [body, s] : block) wet_[cursor[body]++] = s;
}

/// A unit of pressure in particle i pushes sample s by -V_s V_i g (x_s - x_i) directly, and through what the sample
/// extrapolates, V_i W / sum V W, by that share of the sample's area -V_s sum V_k g (x_s - x_k).
void BodyRows::add_rows(const Neighbourhood& items, const Samples& samples, const exchange::BodyState& state,
                        std::uint32_t body, const std::vector<SampleSums>& sums, const std::vector<float>& inverse_w,
                        const KeptPairs& pairs, const PassConstants& constants, std::vector<std::uint32_t>& row_of,
                        std::vector<Row>& out) const {
  const Eigen::Vector3f quantum = items.coordinates().quantum.cast<float>();
  const Quat q = rotation_of(state);
  for (std::uint32_t w = first_wet_[body]; w < first_wet_[body + 1]; ++w) {
    const std::uint32_t s = wet_[w], item = items.sample_item[s], sample = items.source[item] & ~Neighbourhood::kSample;
    const Record& own = items.record[item];
    const Eigen::Vector3f arm = (q * samples.local[sample].cast<double>()).cast<float>();
    const Eigen::Vector3f area = Eigen::Vector3f::Map(sums[s].g);
    const float *slope = pairs.slopes_of(item), *value = pairs.values_of(item);  // V_i g, V_i W
    const std::uint32_t* list = items.lists.of(item);
    for (std::uint32_t k = 0; k < items.lists.count[item]; ++k) {
      const Record& other = items.record[list[k]];
      Eigen::Vector3f r(static_cast<float>(static_cast<std::int32_t>(own.x - other.x)) * quantum[0],
                        static_cast<float>(static_cast<std::int32_t>(own.y - other.y)) * quantum[1],
                        static_cast<float>(static_cast<std::int32_t>(own.z - other.z)) * quantum[2]);
      if (constants.kernel.dimension == 2) r[1] = 0;
      const Eigen::Vector3f push = own.volume * (slope[k] * r + value[k] * inverse_w[s] * area);  // of samples negative
      const Eigen::Vector3f turn = arm.cross(push);
      const std::uint32_t particle = items.source[list[k]];
      if (row_of[particle] == kNone) {
        row_of[particle] = static_cast<std::uint32_t>(out.size());
        out.push_back({particle, body, {}});
      }
      Row& row = out[row_of[particle]];
      for (int c = 0; c < 3; ++c) row.u[c] += push[c], row.u[3 + c] += turn[c];
    }
  }
}

void BodyRows::index_particles(std::size_t particles) {
  std::vector<std::uint32_t> at(particles + 1, 0);
  for (const std::vector<Row>& rows : rows_)
    for (const Row& row : rows) ++at[row.particle + 1];
  particle_start_.clear();
  for (std::size_t p = 0; p < particles; ++p) {
    if (at[p + 1] > 0) particle_start_.push_back(at[p]);
    at[p + 1] += at[p];
  }
  count_ = at[particles];
  particle_start_.push_back(count_);
  by_particle_.resize(count_);
  for (const std::vector<Row>& rows : rows_)
    for (const Row& row : rows) by_particle_[at[row.particle]++] = &row;
}

void BodyRows::reduce(std::span<const float> x, std::vector<Vector6>& y) const {
  y.resize(root_.size());
#pragma omp parallel for num_threads(threads_) schedule(static, 1) if (count_ > kSerial)
  for (std::size_t b = 0; b < root_.size(); ++b) {
    y[b].setZero();
    for (const Row& row : rows_[b]) {
      const double value = x[row.particle];
      for (int c = 0; c < 6; ++c) y[b][c] += value * row.u[c];
    }
  }
}

template <class Add>
void BodyRows::for_each_row(std::span<const Vector6> y, Add&& add) const {
  const std::size_t count = particle_start_.size() - 1;
#pragma omp parallel for num_threads(threads_) schedule(static) if (count_ > kSerial)
  for (std::size_t p = 0; p < count; ++p)
    for (std::uint32_t k = particle_start_[p]; k < particle_start_[p + 1]; ++k) {
      const Row& row = *by_particle_[k];
      double sum = 0;
      for (int c = 0; c < 6; ++c) sum += row.u[c] * y[row.body][c];
      add(row.particle, static_cast<float>(sum));
    }
}

void BodyRows::spread(std::span<const Vector6> y, std::span<float> out) const {
  for_each_row(y, [&](std::uint32_t particle, float value) { out[particle] += value; });
}

void BodyRows::spread_scaled(std::span<const Vector6> y, std::span<const float> diagonal, std::span<float> out) const {
  for_each_row(y, [&](std::uint32_t particle, float value) { out[particle] -= value / diagonal[particle]; });
}

bool BodyRows::has_piston() const {
  constexpr float kOneSided = 0.5f;  // share of the push on all sides that is left of it; around a body: none
  return std::ranges::any_of(rows_, [&](const std::vector<Row>& rows) {
    Eigen::Matrix<float, 6, 1> all = Eigen::Matrix<float, 6, 1>::Zero();
    float sizes = 0;
    for (const Row& row : rows) {
      const auto u = Eigen::Map<const Eigen::Matrix<float, 6, 1>>(row.u);
      all += u, sizes += u.norm();
    }
    return all.norm() > kOneSided * sizes;
  });
}

void BodyRows::factor(std::span<const float> diagonal) {
  slot_.assign(root_.size(), kNone);
  std::uint32_t slots = 0;
  for (std::size_t b = 0; b < root_.size(); ++b)
    if (moves(b)) slot_[b] = slots++;
  if (slots == 0) return;
  std::vector<Matrix6> own(slots, Matrix6::Zero());  // of each body
  for_each_by_turns(root_.size(), count_ > kSerial ? threads_ : 1, [&](std::size_t b) {
    if (!moves(b)) return;
    Matrix6 sum = Matrix6::Zero();
    for (const Row& row : rows_[b]) {
      const Vector6 u = wide(row.u);
      sum.noalias() += u / diagonal[row.particle] * u.transpose();
    }
    own[slot_[b]] = sum;
  });
  // Of two bodies at the same particles, at the one before: the lower half, by columns, is enough.
  shared_.resize(own.size());
  for (std::vector<Shared>& column : shared_) column.clear();
  for (std::size_t p = 0; p + 1 < particle_start_.size(); ++p) {
    const std::uint32_t begin = particle_start_[p], end = particle_start_[p + 1];
    for (std::uint32_t s = begin; s < end; ++s)
      for (std::uint32_t r = s + 1; r < end; ++r) {
        const Row &before = *by_particle_[s], &after = *by_particle_[r];
        std::vector<Shared>& column = shared_[slot_[before.body]];
        auto with = std::ranges::find(column, slot_[after.body], &Shared::slot);
        if (with == column.end()) with = column.insert(with, {slot_[after.body], Matrix6::Zero()});
        with->block.noalias() += wide(after.u) / diagonal[after.particle] * wide(before.u).transpose();
      }
  }
  const int unknowns = static_cast<int>(6 * own.size());
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  std::vector<Slots> touching{{static_cast<std::uint32_t>(own.size()), 0}};
  double largest = 0;
  for (std::size_t k = 0; k < own.size(); ++k) {
    largest = std::max(largest, own[k].trace());
    std::ranges::sort(shared_[k], {}, &Shared::slot);
    for (const Shared& other : shared_[k]) touching.emplace_back(other.slot, k);
    for (int j = 0; j < 6; ++j) {
      const int column = 6 * static_cast<int>(k) + j;
      matrix.startVec(column);
      for (int i = j; i < 6; ++i) matrix.insertBack(6 * static_cast<int>(k) + i, column) = own[k](i, j) + (i == j);
      for (const Shared& other : shared_[k])
        for (int i = 0; i < 6; ++i) matrix.insertBack(6 * static_cast<int>(other.slot) + i, column) = other.block(i, j);
    }
  }
  matrix.finalize();
  // Blocks of bodies that share particles add up; more than two bodies at one particle are taken to be rare.
  norm_ = 2 * largest;
  if (touching != touching_) {
    touching_ = std::move(touching);
    factor_.analyzePattern(matrix);
  }
  factor_.factorize(matrix);
}

void BodyRows::solve(std::vector<Vector6>& y) const {
  Eigen::VectorXd packed(factor_.rows());
  for (std::size_t b = 0; b < y.size(); ++b)
    if (slot_[b] != kNone) packed.segment<6>(6 * slot_[b]) = y[b];
  packed = factor_.solve(packed).eval();
  for (std::size_t b = 0; b < y.size(); ++b)
    if (slot_[b] != kNone) y[b] = packed.segment<6>(6 * slot_[b]);
}

std::size_t BodyRows::memory() const {
  std::size_t words = particle_start_.capacity() + first_wet_.capacity() + wet_.capacity() + slot_.capacity();
  std::size_t rows = 0, blocks = 0;
  for (const auto& of_body : rows_) rows += of_body.capacity();
  for (const auto& row_of : row_of_) words += row_of.capacity();
  for (const auto& column : shared_) blocks += column.capacity();
  return rows * sizeof(Row) + by_particle_.capacity() * sizeof(Row*) + words * sizeof(std::uint32_t) +
         root_.capacity() * sizeof(Matrix6) + blocks * sizeof(Shared);
}

}  // namespace ballast::fluid
