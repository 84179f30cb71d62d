// How deep two posed solids overlap: the deepest point of one's surface inside the other, by branch and bound.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/geometry/form.h"
#include "common/geometry/solid.h"

namespace ballast {
namespace {

using Triangle = std::array<Vec3, 3>;

double extent(const Solid& solid) {
  const Box3 b = solid.bounds();
  return (b.max - b.min).maxCoeff();
}

// Searches the surface of `from` for the point deepest inside `into`. Works in the frame of `from`.
class DeepestPoint {
 public:
  DeepestPoint(const Solid& from, const Pose& pose_from, const Solid& into, const Pose& pose_into, double resolution)
      : from_(from), into_(into), resolution_(resolution), size_(extent(from)) {
    turn_ = pose_into.rotation.conjugate() * pose_from.rotation;
    shift_ = pose_into.rotation.conjugate() * (pose_from.position - pose_into.position);
  }
  double run() {
    const TriangleMesh mesh = from_.surface();
    for (const auto& [a, b, c] : mesh.triangles) {
      search({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
    }
    if (depth_ > 0) climb();
    return depth_;
  }

 private:
  double depth_in_other(const Vec3& p) const { return -into_.distance(turn_ * p + shift_); }

  // Triangles are chords of curved surfaces: points go onto the true surface first.
  void try_point(Vec3 p) {
    double off = from_.distance(p);
    if (depth_in_other(p) + std::abs(off) <= depth_) return;
    for (int i = 0; i < 2 && std::abs(off) > 1e-9 * size_; ++i) {
      p -= off * from_.normal(p);
      off = from_.distance(p);
    }
    if (std::abs(off) > 1e-6 * size_) return;
    if (const double depth = depth_in_other(p); depth > depth_) {
      depth_ = depth;
      deepest_ = p;
    }
  }

  // Distance changes by at most what one moves, so a triangle is left out once it cannot hold a deeper point.
  void search(const Triangle& t) {
    const auto [low, high] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
    if (from_.dimension() == 2 && (low > resolution_ || high < -resolution_)) return;
    const Vec3 centre = (t[0] + t[1] + t[2]) / 3;
    double reach = 0, longest = 0;
    std::size_t split = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      reach = std::max(reach, (t[k] - centre).norm());
      const double edge = (t[(k + 1) % 3] - t[k]).norm();
      if (edge > longest) longest = edge, split = k;
    }
    constexpr double kChord = 0.003;  // of the size, how far triangles may lie below a curved surface
    if (depth_in_other(centre) + reach + kChord * size_ <= depth_) return;
    try_point(centre);
    if (longest <= resolution_) {
      for (const Vec3& corner : t) try_point(corner);
      return;
    }
    const Vec3 &a = t[split], &b = t[(split + 1) % 3], &c = t[(split + 2) % 3], middle = 0.5 * (a + b);
    search({a, middle, c});
    search({middle, b, c});
  }

  // Pattern search over the surface from the deepest point found, down to 1e-4 of the resolution.
  void climb() {
    for (double step = resolution_; step > 1e-4 * resolution_; step *= 0.5) {
      for (int tries = 0; tries < 8; ++tries) {
        const double before = depth_;
        const Vec3 start = deepest_;
        for (int a = 0; a < 3; ++a) {
          if (from_.dimension() == 2 && a == 1) continue;
          try_point(start + step * Vec3::Unit(a));
          try_point(start - step * Vec3::Unit(a));
        }
        if (depth_ <= before) break;
      }
    }
  }

  const Solid &from_, &into_;
  double resolution_, size_;
  Quat turn_;
  Vec3 shift_, deepest_ = Vec3::Zero();
  double depth_ = 0;
};

}  // namespace

double overlap_depth(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b, double resolution) {
  double depth = 0;
  if (std::isfinite(extent(a))) depth = DeepestPoint(a, pose_a, b, pose_b, resolution).run();
  if (std::isfinite(extent(b))) depth = std::max(depth, DeepestPoint(b, pose_b, a, pose_a, resolution).run());
  return depth > 1e-6 * std::min(extent(a), extent(b)) ? depth : 0;
}

}  // namespace ballast
