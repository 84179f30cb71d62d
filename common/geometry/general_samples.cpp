// Samples of any solid that only knows its signed distance.
#include "common/geometry/general_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

namespace ballast::geometry {
namespace {

constexpr int kFine = 4;           // quadrature cells per spacing
constexpr double kApart = 0.85;    // of a spacing, between seeds: leaves about one seed per d^3 (checked in the tests)
constexpr double kClosest = 0.75;  // of a spacing, that relaxing may bring two seeds together
constexpr int kRelaxations = 4;    // moves of the seeds to the centres of what they stand for

struct Point {
  Vec3 position = Vec3::Zero();
  double volume = 0;  // of the cell's solid part
  double depth = 0;
};

// Points in cubic cells of edge `cell`, for finding those near a place.
class Buckets {
 public:
  explicit Buckets(double cell) : cell_(cell) {}
  void add(const Vec3& p, std::uint32_t index) { map_[key(index_of(p))].push_back(index); }
  /// Calls visit(index) for everything in the cells up to `reach` cells away.
  template <class Visit>
  void near(const Vec3& p, int reach, const Visit& visit) const {
    const auto c = index_of(p);
    for (long z = -reach; z <= reach; ++z) {
      for (long y = -reach; y <= reach; ++y) {
        for (long x = -reach; x <= reach; ++x) {
          const auto it = map_.find(key({c[0] + x, c[1] + y, c[2] + z}));
          if (it == map_.end()) continue;
          for (const std::uint32_t i : it->second) visit(i);
        }
      }
    }
  }

 private:
  std::array<long, 3> index_of(const Vec3& p) const {
    return {std::lround(p.x() / cell_), std::lround(p.y() / cell_), std::lround(p.z() / cell_)};
  }
  // 21 bits per axis: two million cells each way.
  static std::uint64_t key(const std::array<long, 3>& c) {
    std::uint64_t k = 0;
    for (const long i : c) k = k << 21 | (static_cast<std::uint64_t>(i) & 0x1fffff);
    return k;
  }
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> map_;
};

class Sampler {
 public:
  Sampler(const Form& form, int dimension, const SampleRequest& request, const CellShare& share)
      : form_(form), flat_(dimension == 2), d_(request.spacing), h_(d_ / kFine), share_(share) {
    filled_ = std::ceil(request.depth / d_ * (1 - 1e-9)) * d_;
    const Box3 b = form.bounds();
    // What lies a little outside the window still draws its share away from samples inside it.
    min_ = b.min.cwiseMax(request.window.min - Vec3::Constant(2 * d_));
    max_ = b.max.cwiseMin(request.window.max + Vec3::Constant(2 * d_));
    if (flat_) min_.y() = max_.y() = 0;
    whole_ = (b.min - min_).isZero() && (b.max - max_).isZero();
    if (flat_)
      whole_ = b.min.x() == min_.x() && b.min.z() == min_.z() && b.max.x() == max_.x() && b.max.z() == max_.z();
  }

  std::vector<SurfaceSample> run() {
    // A solid thinner than the grid can see gets a finer one, so that at least four cells lie across it.
    for (int halvings = 0; halvings < 5; ++halvings) {
      if (halvings > 0) h_ *= 0.5;
      points_.clear();
      deepest_ = 0;
      fill_points();
      if (cut_ || deepest_ >= 2 * h_) break;
    }
    place_seeds();
    if (seeds_.empty()) return {};
    for (int i = 0; i < kRelaxations; ++i) {
      assign();
      relax();
    }
    assign();
    // Filled to its middle, the solid's own volume is exact; the volume of layers comes from the fine grid.
    const double exact = whole_ && !cut_ ? form_.mass_properties().volume : 0;
    const double sum = std::accumulate(shares_.begin(), shares_.end(), 0.0);
    std::vector<SurfaceSample> samples;
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
      if (shares_[i] > 0)
        samples.push_back({seeds_[i], Vec3::Zero(), 0, exact > 0 ? shares_[i] * exact / sum : shares_[i]});
    }
    return samples;
  }

 private:
  // Cubes are halved while they may hold solid of the layers: distance changes by at most what one moves.
  void fill_points() {
    if ((max_ - min_).minCoeff() < 0) return;
    const double extent = (max_ - min_).maxCoeff();
    double edge = h_;
    while (edge < extent + h_) edge *= 2;
    // Centred, so that symmetric solids get symmetric grids.
    const Vec3 centre = 0.5 * (min_ + max_);
    fill_cube(flat_ ? Vec3(centre.x(), 0, centre.z()) : centre, edge);
  }
  void fill_cube(const Vec3& c, double edge) {
    const double reach = 0.5 * edge * (flat_ ? std::sqrt(2.0) : std::sqrt(3.0));
    for (int a = 0; a < 3; ++a) {
      if (c[a] + 0.5 * edge < min_[a] - h_ || c[a] - 0.5 * edge > max_[a] + h_) return;
    }
    const double distance = form_.distance(c);
    if (distance > reach) return;
    if (distance < -filled_ - reach) {
      cut_ = true;
      return;
    }
    if (edge > 1.5 * h_) {
      const double q = 0.25 * edge;
      for (int i = 0; i < 8; ++i) {
        if (flat_ && (i & 2)) continue;
        fill_cube(c + Vec3(i & 1 ? q : -q, flat_ ? 0 : i & 2 ? q : -q, i & 4 ? q : -q), 0.5 * edge);
      }
      return;
    }
    add_point(c, distance);
  }
  void add_point(const Vec3& c, double distance) {
    const double solid = share_ ? share_(c, h_) : std::clamp(0.5 - distance / h_, 0.0, 1.0);
    const double within = std::clamp(0.5 + (distance + filled_) / h_, 0.0, 1.0);
    if (within < 1) cut_ = true;
    const double volume = solid * within * h_ * h_ * (flat_ ? 1 : h_);
    if (volume > 0) points_.push_back({c, volume, std::max(0.0, -distance)});
    deepest_ = std::max(deepest_, -distance);
  }

  double layer_depth(double depth) const { return (std::floor(depth / d_) + 0.5) * d_; }

  // Along the gradient to its layer's depth, as far as the solid is thick enough.
  Vec3 onto_layer(Vec3 p, double target) const {
    double error = std::abs(form_.distance(p) + target);
    for (int i = 0; i < 3 && error > 1e-3 * d_; ++i) {
      Vec3 q = p - (form_.distance(p) + target) * form_.normal(p);
      if (flat_) q.y() = 0;
      const double after = std::abs(form_.distance(q) + target);
      if (after >= error) break;
      p = q;
      error = after;
    }
    return p;
  }

  // Outer layers first, points nearest to their layer's depth first; a point becomes a seed if no seed is near.
  void place_seeds() {
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto rank = [&](std::uint32_t i) {
      const double depth = points_[i].depth;
      return std::floor(depth / d_) + 0.25 * std::floor(4 * std::abs(depth - layer_depth(depth)) / d_);
    };
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return rank(a) < rank(b); });
    Buckets taken(d_);
    for (const std::uint32_t i : order) {
      if (points_[i].depth >= filled_) continue;  // half of its cell belongs to the last layer, a seed does not
      if (crowded(taken, points_[i].position, 0.5 * kApart)) continue;  // spares most of the projections
      const Vec3 p = onto_layer(points_[i].position, layer_depth(points_[i].depth));
      if (form_.distance(p) >= 0 || crowded(taken, p, kApart)) continue;
      taken.add(p, static_cast<std::uint32_t>(seeds_.size()));
      seeds_.push_back(p);
      targets_.push_back(layer_depth(points_[i].depth));
    }
  }
  bool crowded(const Buckets& taken, const Vec3& p, double apart) const {
    bool found = false;
    taken.near(p, 1, [&](std::uint32_t i) { found = found || (seeds_[i] - p).norm() < apart * d_; });
    return found;
  }

  void assign() {
    grid_ = Buckets(d_);
    for (std::uint32_t i = 0; i < seeds_.size(); ++i) grid_.add(seeds_[i], i);
    shares_.assign(seeds_.size(), 0);
    centres_.assign(seeds_.size(), Vec3::Zero());
    for (const Point& point : points_) {
      double best = kInf;
      std::uint32_t owner = 0;
      for (int reach = 1; reach <= 3 && best == kInf; ++reach) {
        grid_.near(point.position, reach, [&](std::uint32_t i) {
          const double r = (seeds_[i] - point.position).squaredNorm();
          if (r < best || (r == best && i < owner)) best = r, owner = i;
        });
      }
      if (best == kInf) continue;
      shares_[owner] += point.volume;
      centres_[owner] += point.volume * point.position;
    }
  }
  void relax() {
    for (std::size_t i = 0; i < seeds_.size(); ++i) {
      if (shares_[i] <= 0) continue;
      const Vec3 p = onto_layer(centres_[i] / shares_[i], targets_[i]);
      if (form_.distance(p) < 0 && gap(p, i) >= std::min(kClosest * d_, gap(seeds_[i], i))) seeds_[i] = p;
    }
  }
  // To the nearest other seed, as far as one spacing.
  double gap(const Vec3& p, std::size_t self) const {
    double nearest = d_;
    grid_.near(p, 1, [&](std::uint32_t i) {
      if (i != self) nearest = std::min(nearest, (seeds_[i] - p).norm());
    });
    return nearest;
  }

  const Form& form_;
  bool flat_, whole_ = false, cut_ = false;  // cut_: some of the solid lies deeper than the layers
  double d_, h_, filled_ = 0, deepest_ = 0;
  const CellShare& share_;
  Vec3 min_, max_;
  Buckets grid_{d_};
  std::vector<Point> points_;
  std::vector<Vec3> seeds_, centres_;
  std::vector<double> targets_, shares_;
};

}  // namespace

std::vector<SurfaceSample> general_samples(const Form& form, int dimension, const SampleRequest& request,
                                           const CellShare& share) {
  return Sampler(form, dimension, request, share).run();
}

}  // namespace ballast::geometry
