// Signed distance to a closed triangle mesh: bounding-volume tree, sign by angle-weighted pseudonormals
// (Baerentzen & Aanaes, IEEE TVCG 11(3), 2005).
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/geometry/solid.h"

namespace ballast::geometry {

class MeshDistance {
 public:
  explicit MeshDistance(const TriangleMesh& mesh);

  struct Nearest {
    Vec3 point = Vec3::Zero();   ///< on the surface
    Vec3 normal = Vec3::Zero();  ///< unit pseudonormal there
    double distance = 0;         ///< negative inside
  };
  /// `within`: a distance known to be enough, which shortens the search; the nearest point must not lie farther.
  Nearest nearest(const Vec3& p, double within = std::numeric_limits<double>::infinity()) const;
  /// Triangles whose bounds overlap the box from `low` to `high`, in an order that depends on the mesh only.
  void overlapping(const Vec3& low, const Vec3& high, std::vector<std::uint32_t>& out) const;

 private:
  // Axis-aligned box over triangles [first, first + count) of order_, or over two children (count 0).
  struct Node {
    Vec3 min, max;
    std::uint32_t first = 0, count = 0, right = 0;  // the left child follows its parent
  };
  struct Hit {
    Vec3 point;
    double squared;
    std::uint32_t triangle;
    int feature;  // 0 face, 1..3 edges 0-1, 1-2, 2-0, 4..6 vertices
  };
  std::uint32_t build(std::uint32_t first, std::uint32_t count);
  void make_normals();
  void visit_leaf(const Node& node, const Vec3& p, Hit& best) const;

  const TriangleMesh mesh_;
  std::vector<std::uint32_t> order_;
  std::vector<std::array<Vec3, 3>> corners_;  // of order_, side by side for the leaves
  std::vector<Node> nodes_;
  std::vector<std::array<Vec3, 7>> normals_;  // per triangle and feature
};

}  // namespace ballast::geometry
