// Voids: places that a fluid encloses and that have no particle near. A grid is painted with the particles, then
// flooded from its rim; what is neither painted nor flooded is a void, and flooded in its turn to see how large it is.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "fluid_server/probes/probes.h"

namespace ballast::fluid {

namespace {

using Cell = std::array<std::ptrdiff_t, 3>;

enum class Place : std::uint8_t { kEmpty, kNear, kCounted };

constexpr double kMostCells = 1e8;  // beyond, strays lie too far away for a grid around all

/// Places half a spacing apart around all particles, with an empty rim.
class Grid {
 public:
  Grid(const std::vector<Vec3>& points, double spacing, bool flat) : step_(spacing / 2), flat_(flat) {
    Box3 box{points.front(), points.front()};
    for (const Vec3& p : points) box.min = box.min.cwiseMin(p), box.max = box.max.cwiseMax(p);
    origin_ = box.min.array() - 4 * step_;
    for (int k = 0; k < 3; ++k)
      size_[k] = flat && k == 1 ? 1 : static_cast<std::ptrdiff_t>((box.max[k] - origin_[k]) / step_) + 6;
  }

  double cells() const {
    return static_cast<double>(size_[0]) * static_cast<double>(size_[1]) * static_cast<double>(size_[2]);
  }

  /// Marks what is within a spacing of a particle.
  void paint(const std::vector<Vec3>& points) {
    places_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]), Place::kEmpty);
    for (const Vec3& p : points) {
      const Vec3 at = (p - origin_) / step_;
      Cell low, high;
      for (int k = 0; k < 3; ++k) {
        low[k] = flat_ && k == 1 ? 0 : static_cast<std::ptrdiff_t>(std::ceil(at[k] - 2));
        high[k] = flat_ && k == 1 ? 0 : static_cast<std::ptrdiff_t>(std::floor(at[k] + 2));
      }
      for (Cell c = low; c[2] <= high[2]; ++c[2])
        for (c[1] = low[1]; c[1] <= high[1]; ++c[1])
          for (c[0] = low[0]; c[0] <= high[0]; ++c[0]) {
            Vec3 way = Vec3(static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])) - at;
            if (flat_) way[1] = 0;
            if (way.squaredNorm() <= 4) places_[index(c)] = Place::kNear;
          }
    }
  }

  /// Of the largest void, m^3; m^2 where flat.
  double largest() {
    flood({0, 0, 0});  // the rim is empty and in one piece
    std::size_t most = 0;
    Cell c;
    for (c[2] = 0; c[2] < size_[2]; ++c[2])
      for (c[1] = 0; c[1] < size_[1]; ++c[1])
        for (c[0] = 0; c[0] < size_[0]; ++c[0])
          if (places_[index(c)] == Place::kEmpty) most = std::max(most, flood(c));
    return static_cast<double>(most) * std::pow(step_, flat_ ? 2 : 3);
  }

 private:
  /// Counts, and marks, the empty places that are joined to one.
  std::size_t flood(const Cell& start) {
    std::vector<Cell> front = {start};
    places_[index(start)] = Place::kCounted;
    std::size_t count = 0;
    while (!front.empty()) {
      const Cell from = front.back();
      front.pop_back();
      ++count;
      for (int k = 0; k < 3; ++k)
        for (const std::ptrdiff_t by : {-1, 1}) {
          Cell c = from;
          c[k] += by;
          if (c[k] < 0 || c[k] >= size_[k] || places_[index(c)] != Place::kEmpty) continue;
          places_[index(c)] = Place::kCounted;
          front.push_back(c);
        }
    }
    return count;
  }

  std::size_t index(const Cell& c) const {
    return static_cast<std::size_t>(c[0] + size_[0] * (c[1] + size_[1] * c[2]));
  }

  double step_;
  bool flat_;
  Vec3 origin_;
  Cell size_;
  std::vector<Place> places_;
};

}  // namespace

double largest_void(const WcsphFluid& fluid, std::size_t which) {
  const Particles& particles = fluid.particles();
  std::vector<Vec3> points;
  for (std::size_t f = 0; f < particles.size(); ++f) {
    const Record& r = particles.record[f];
    if (&fluid.fluid_of(particles.id[f]) == &fluid.filled().fluids[which])
      points.push_back(fluid.coordinates().to_metres(r.x, r.y, r.z));
  }
  if (points.empty()) return 0;
  Grid grid(points, fluid.spacing(), fluid.constants().kernel.dimension == 2);
  if (grid.cells() > kMostCells) return std::numeric_limits<double>::quiet_NaN();
  grid.paint(points);
  return grid.largest();
}

}  // namespace ballast::fluid
