// Counting sort of particles by cell, merged with the boundary samples near them. The order within a cell is that
// before, so the result does not depend on the number of threads, and where no item leaves its cell nothing is sorted.
#include "fluid_server/neighbours/neighbourhood.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "fluid_server/neighbours/resize.h"

namespace ballast::fluid {

namespace {

constexpr std::uint32_t kLongestPause = 63;  // searches
constexpr std::uint32_t kRowsAtATime = 4;    // that a thread takes: those with water lie low

std::uint32_t whole_cells(double length, double size) {
  return static_cast<std::uint32_t>(std::clamp(std::floor(length / size), 1.0, 65535.0));
}

/// First particle of the block that thread t of n sorts.
std::size_t block_begin(std::size_t size, int t, int n) {
  return size * static_cast<std::size_t>(t) / static_cast<std::size_t>(n);
}

}  // namespace

Neighbourhood::Neighbourhood(const Coordinates& coordinates, double support, int dimension, int threads)
    : coordinates_(coordinates), threads_(threads) {
  const Vec3 extent = coordinates.domain.max - coordinates.domain.min;
  // A hair more than the support, so that rounding to quanta cannot lose a pair.
  const double size = support * (1 + 1e-6);
  cells_.count = {whole_cells(extent[0], size / Cells::kFine), dimension == 2 ? 1 : whole_cells(extent[1], size),
                  whole_cells(extent[2], size)};
  cells_.periodic = coordinates.periodic;
  const std::size_t n = cells_.cells();
  static_start_.assign(n + 1, 0);
  histogram_.resize(static_cast<std::size_t>(std::min(threads, 8)));
  row_touched_.assign(histogram_.size(), std::vector<std::uint8_t>(cells_.rows(), 0));
  row_filled_.assign(cells_.rows(), 0);
  row_fluid_.resize(cells_.rows());
  row_all_.resize(cells_.rows());
  row_counts_.resize(cells_.rows());
  row_place_.resize(cells_.rows());
  occupied_.resize(static_cast<std::size_t>(cells_.rows()) * cells_.blocks_x());
  active_.resize(occupied_.size());
}

void Neighbourhood::set_static_samples(std::span<const Record> samples) {
  fixed_ = samples;
  std::vector<std::uint32_t> cell(samples.size());
  std::fill(static_start_.begin(), static_start_.end(), 0);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    cell[s] = cells_.cell(samples[s].x, samples[s].y, samples[s].z);
    ++static_start_[cell[s] + 1];
  }
  for (std::size_t c = 1; c < static_start_.size(); ++c) static_start_[c] += static_start_[c - 1];
  std::vector<std::uint32_t> cursor(static_start_.begin(), static_start_.end() - 1);
  static_source_.resize(samples.size());
  for (std::size_t s = 0; s < samples.size(); ++s) {
    static_source_[cursor[cell[s]]++] = static_cast<std::uint32_t>(s);
  }
}

void Neighbourhood::rebuild(const Particles& before, Particles& after, std::span<const Record> moving,
                            std::uint32_t first_moving) {
  if (lists.valid && keep_order(before, after, moving, first_moving)) return;
  decide_to_measure();
  find_rows(before);
  count_particles();
  total_rows();
  activate_rows();
  count_moving(moving);
  place_rows();
  scatter(before, after, moving, first_moving);
}

/// Looking for the room that pairs have costs a twentieth of a step: where lists could not be kept even once it is
/// tried again after 1, 3, 7 .. 63 searches.
void Neighbourhood::decide_to_measure() {
  if (lists.valid || was_kept_) {
    pause_ = was_kept_ ? 0 : std::min(2 * pause_ + 1, kLongestPause);
    wait_ = pause_;
  } else if (wait_ > 0) {
    --wait_;
  }
  lists.valid = was_kept_ = false;
  lists.measure = may_keep && wait_ == 0;
}

void Neighbourhood::count_kept(std::uint64_t made_again) {
  searches.lists += size(), searches.made_again += made_again;
  if (made_again > size() / 2) {  // hardly less work than a search
    lists.valid = was_kept_ = false;
    wait_ = pause_ = std::min(2 * pause_ + 1, kLongestPause);
  } else if (lists.all_used() > lists.used_at_first * 5 / 4) {
    lists.valid = false;  // too many places whose lists have grown out of them
  }
}

/// Largest displacement of an item since the last time, m; infinite if one has left its cell or come into play.
double Neighbourhood::largest_move(const Particles& before, std::span<const Record> moving) const {
  if (before.size() != fluid_item.size() || moving.size() != moving_cell_.size()) return HUGE_VAL;
  double largest2 = 0;
  const auto check = [this](const Record& r, std::uint32_t item) {
    if (cells_.cell(r.x, r.y, r.z) != cells_.cell(x[item], y[item], z[item])) return HUGE_VAL;
    const auto metres = [](std::uint32_t to, std::uint32_t from, double quantum) {
      return quantum * static_cast<double>(static_cast<std::int32_t>(to - from));
    };
    const Vec3& q = coordinates_.quantum;
    return Vec3(metres(r.x, x[item], q[0]), metres(r.y, y[item], q[1]), metres(r.z, z[item], q[2])).squaredNorm();
  };
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(max : largest2)
  for (std::size_t f = 0; f < before.size(); ++f) largest2 = std::max(largest2, check(before.record[f], fluid_item[f]));
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(max : largest2)
  for (std::size_t s = 0; s < moving.size(); ++s) {
    if (cell_of_moving(moving[s]) != moving_cell_[s])
      largest2 = HUGE_VAL;
    else if (moving_cell_[s] != kNone)
      largest2 = std::max(largest2, check(moving[s], moving_item_[s]));
  }
  return std::sqrt(largest2);
}

bool Neighbourhood::keep_order(const Particles& before, Particles& after, std::span<const Record> moving,
                               std::uint32_t first_moving) {
  const double move = largest_move(before, moving);
  if (!std::isfinite(move)) return false;
  lists.moved += move * (1 + 1e-6);
  was_kept_ = true;
  after.has_compression = before.has_compression;
  after.resize(before.size());
#pragma omp parallel num_threads(threads_)
  {
#pragma omp for schedule(static) nowait
    for (std::size_t f = 0; f < before.size(); ++f) {
      before.for_each_field([&](auto field) { (after.*field)[f] = (before.*field)[f]; });
      put(fluid_item[f], before.record[f], static_cast<std::uint32_t>(f));
    }
#pragma omp for schedule(static, kRowsAtATime) nowait
    for (std::uint32_t row = 0; row < cells_.rows(); ++row)
      if (row_filled_[row]) put_static(row);
#pragma omp for schedule(static)
    for (std::size_t s = 0; s < moving.size(); ++s)
      if (moving_cell_[s] != kNone)
        put(moving_item_[s], moving[s], kSample | (first_moving + static_cast<std::uint32_t>(s)));
  }
  return true;
}

void Neighbourhood::find_rows(const Particles& before) {
  const int blocks = static_cast<int>(histogram_.size());
  const std::uint32_t nx = cells_.count[0];
  cell_of_.resize(before.size());
#pragma omp parallel for num_threads(threads_) schedule(static, 1)
  for (int t = 0; t < blocks; ++t) {
    auto& touched = row_touched_[static_cast<std::size_t>(t)];
    std::fill(touched.begin(), touched.end(), 0);
    const std::size_t end = block_begin(before.size(), t + 1, blocks);
    for (std::size_t f = block_begin(before.size(), t, blocks); f < end; ++f) {
      const Record& r = before.record[f];
      const std::uint32_t row = cells_.row(r.y, r.z);
      cell_of_[f] = row * nx + Cells::along(r.x, nx);
      touched[row] = 1;
    }
  }
  std::uint32_t found = 0;
  for (std::uint32_t row = 0; row < cells_.rows(); ++row) {
    const bool any = std::any_of(row_touched_.begin(), row_touched_.end(), [row](const auto& t) { return t[row]; });
    row_counts_[row] = any ? found++ : kNone;
  }
  resize_gently(fluid_count_, std::size_t{found} * nx);
  for (auto& histogram : histogram_) resize_gently(histogram, fluid_count_.size());
}

void Neighbourhood::count_particles() {
  const int blocks = static_cast<int>(histogram_.size());
#pragma omp parallel for num_threads(threads_) schedule(static, 1)
  for (int t = 0; t < blocks; ++t) {
    auto& histogram = histogram_[static_cast<std::size_t>(t)];
    std::fill(histogram.begin(), histogram.end(), 0);
    const std::size_t end = block_begin(cell_of_.size(), t + 1, blocks);
    for (std::size_t f = block_begin(cell_of_.size(), t, blocks); f < end; ++f) ++histogram[count_at(cell_of_[f])];
  }
}

void Neighbourhood::total_rows() {
  const std::uint32_t nx = cells_.count[0], blocks_x = cells_.blocks_x();
#pragma omp parallel for num_threads(threads_) schedule(static, kRowsAtATime)
  for (std::uint32_t row = 0; row < cells_.rows(); ++row) {
    std::uint32_t total = 0;
    row_fluid_[row] = 0;
    if (row_counts_[row] == kNone) continue;
    std::uint8_t* occupied = occupied_.data() + static_cast<std::size_t>(row) * blocks_x;
    std::memset(occupied, 0, blocks_x);
    for (std::uint32_t cx = 0; cx < nx; ++cx) {
      const std::size_t c = std::size_t{row_counts_[row]} * nx + cx;
      std::uint32_t here = 0;
      for (auto& histogram : histogram_) {  // each thread's offset within the cell
        const std::uint32_t count = histogram[c];
        histogram[c] = here;
        here += count;
      }
      fluid_count_[c] = here;
      total += here;
      if (here) occupied[cx / Cells::kFine] = 1;
    }
    row_fluid_[row] = total;
  }
}

void Neighbourhood::activate_rows() {
  const std::uint32_t nx = cells_.count[0], ny = cells_.count[1], nz = cells_.count[2];
  const int blocks_x = static_cast<int>(cells_.blocks_x());
  // A last block of fewer than kFine cells is shorter than the support: on a periodic axis look one block further.
  const int reach = cells_.periodic[0] ? 2 : 1;
#pragma omp parallel for num_threads(threads_) schedule(static, kRowsAtATime)
  for (std::uint32_t row = 0; row < cells_.rows(); ++row) {
    std::uint8_t* active = active_.data() + static_cast<std::size_t>(row) * cells_.blocks_x();
    std::memset(active, 0, cells_.blocks_x());
    bool any = false;
    const int cy = static_cast<int>(row % ny), cz = static_cast<int>(row / ny);
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        int y2 = cy + dy, z2 = cz + dz;
        const int iny = static_cast<int>(ny), inz = static_cast<int>(nz);
        if (cells_.periodic[1]) y2 = (y2 + iny) % iny;
        if (cells_.periodic[2]) z2 = (z2 + inz) % inz;
        if (y2 < 0 || z2 < 0 || y2 >= iny || z2 >= inz) continue;
        const std::uint32_t other = static_cast<std::uint32_t>(z2 * iny + y2);
        if (!row_fluid_[other]) continue;
        any = true;
        const std::uint8_t* occupied = occupied_.data() + static_cast<std::size_t>(other) * cells_.blocks_x();
        for (int b = 0; b < blocks_x; ++b) {
          if (!occupied[b]) continue;
          for (int d = -reach; d <= reach; ++d) {
            int at = b + d;
            if (cells_.periodic[0]) at = (at + blocks_x) % blocks_x;
            if (at >= 0 && at < blocks_x) active[at] = 1;
          }
        }
      }
    }
    row_all_[row] = 0;
    row_place_[row] = any ? 0 : kNone;
    if (!any) continue;
    std::uint32_t all = row_fluid_[row];
    for (std::uint32_t b = 0; b < cells_.blocks_x(); ++b) {
      if (!active[b]) continue;
      const std::size_t first = static_cast<std::size_t>(row) * nx + b * Cells::kFine;
      const std::size_t last = static_cast<std::size_t>(row) * nx + std::min(nx, (b + 1) * Cells::kFine);
      all += static_start_[last] - static_start_[first];
    }
    row_all_[row] = all;
  }
  std::uint32_t found = 0;
  for (std::uint32_t& place : row_place_)
    if (place != kNone) place = found++;
  resize_gently(start_, std::size_t{found} * (nx + 1));
  resize_gently(start_fluid_, start_.size());
  resize_gently(moving_count_, std::size_t{found} * nx);
  std::fill(moving_count_.begin(), moving_count_.end(), 0);
}

void Neighbourhood::count_moving(std::span<const Record> moving) {
  moving_cell_.resize(moving.size());
  moving_item_.resize(moving.size());
  for (std::size_t s = 0; s < moving.size(); ++s) {
    moving_cell_[s] = cell_of_moving(moving[s]);
    if (moving_cell_[s] == kNone) continue;
    const std::uint32_t nx = cells_.count[0], row = moving_cell_[s] / nx;
    ++moving_count_[place_of(row) * nx + moving_cell_[s] % nx];
    ++row_all_[row];
  }
}

/// kNone if no particle can have it within the support.
std::uint32_t Neighbourhood::cell_of_moving(const Record& r) const {
  if (r.volume == 0) return kNone;  // outside the domain
  const std::uint32_t row = cells_.row(r.y, r.z), cx = Cells::along(r.x, cells_.count[0]);
  const bool active = active_[static_cast<std::size_t>(row) * cells_.blocks_x() + cx / Cells::kFine];
  return active ? row * cells_.count[0] + cx : kNone;
}

void Neighbourhood::put(std::uint32_t item, const Record& r, std::uint32_t from) {
  x[item] = r.x;
  y[item] = r.y;
  z[item] = r.z;
  record[item] = r;
  source[item] = from;
}

void Neighbourhood::place_rows() {
  std::uint32_t all = 0, fluid = 0;
  for (std::uint32_t row = 0; row < cells_.rows(); ++row) {  // counts become starts
    const std::uint32_t a = row_all_[row], f = row_fluid_[row];
    row_all_[row] = all;
    row_fluid_[row] = fluid;
    row_filled_[row] = a > 0;
    all += a;
    fluid += f;
  }
  for (auto* v : {&x, &y, &z, &source}) resize_gently(*v, all + kTail);
  resize_gently(record, all + kTail);
  fluid_item.resize(fluid);
  resize_gently(sample_item, all - fluid);
  const std::uint32_t nx = cells_.count[0];
#pragma omp parallel for num_threads(threads_) schedule(static, kRowsAtATime)
  for (std::uint32_t row = 0; row < cells_.rows(); ++row) {
    if (!row_filled_[row]) continue;
    std::uint32_t item = row_all_[row], particle = row_fluid_[row];
    const bool any_fluid = row_counts_[row] != kNone;
    const std::uint8_t* active = active_.data() + static_cast<std::size_t>(row) * cells_.blocks_x();
    const std::size_t place = place_of(row), first = place * (nx + 1);
    for (std::uint32_t cx = 0; cx < nx; ++cx) {
      const std::size_t c = static_cast<std::size_t>(row) * nx + cx;
      start_[first + cx] = item;
      start_fluid_[first + cx] = particle;
      const std::uint32_t here = any_fluid ? fluid_count_[std::size_t{row_counts_[row]} * nx + cx] : 0;
      item += here + moving_count_[place * nx + cx];
      particle += here;
      if (active[cx / Cells::kFine]) item += static_start_[c + 1] - static_start_[c];
    }
    start_[first + nx] = item;
    start_fluid_[first + nx] = particle;
    put_static(row);
  }
}

/// Static samples of a row behind the particles of their cells.
void Neighbourhood::put_static(std::uint32_t row) {
  const std::uint32_t nx = cells_.count[0];
  const std::uint8_t* active = active_.data() + static_cast<std::size_t>(row) * cells_.blocks_x();
  for (std::uint32_t cx = 0; cx < nx; ++cx) {
    if (!active[cx / Cells::kFine]) continue;
    const std::size_t c = static_cast<std::size_t>(row) * nx + cx, at = place_of(row) * (nx + 1) + cx;
    const std::uint32_t particle = start_fluid_[at + 1];
    std::uint32_t item = start_[at] + particle - start_fluid_[at];
    for (std::uint32_t s = static_start_[c]; s < static_start_[c + 1]; ++s, ++item) {
      put(item, fixed_[static_source_[s]], kSample | static_source_[s]);
      sample_item[item - particle] = item;
    }
  }
}

void Neighbourhood::scatter(const Particles& before, Particles& after, std::span<const Record> moving,
                            std::uint32_t first_moving) {
  const int blocks = static_cast<int>(histogram_.size());
  const std::uint32_t nx = cells_.count[0];
  after.has_compression = before.has_compression;
  after.resize(before.size());
#pragma omp parallel for num_threads(threads_) schedule(static, 1)
  for (int t = 0; t < blocks; ++t) {
    auto& cursor = histogram_[static_cast<std::size_t>(t)];
    const std::size_t end = block_begin(before.size(), t + 1, blocks);
    for (std::size_t f = block_begin(before.size(), t, blocks); f < end; ++f) {
      const std::uint32_t c = cell_of_[f], rank = cursor[count_at(c)]++;
      const std::size_t first = start_at(c);
      const std::uint32_t to = start_fluid_[first] + rank, item = start_[first] + rank;
      before.for_each_field([&](auto field) { (after.*field)[to] = (before.*field)[f]; });
      put(item, before.record[f], to);
      fluid_item[to] = item;
    }
  }
  for (std::size_t s = moving.size(); s-- > 0;) {  // backwards: the count left is the rank
    const std::uint32_t c = moving_cell_[s];
    if (c == kNone) continue;
    const std::size_t end = start_at(c) + 1;
    const std::uint32_t item = start_[end] - 1 - (--moving_count_[place_of(c / nx) * nx + c % nx]);
    moving_item_[s] = item;
    put(item, moving[s], kSample | (first_moving + static_cast<std::uint32_t>(s)));
    sample_item[item - start_fluid_[end]] = item;
  }
}

}  // namespace ballast::fluid
