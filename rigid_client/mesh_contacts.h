// Contacts between two triangle meshes, convex or not: the exact features of polyhedra (vertex on face, edge on edge)
// instead of pairs of intersecting triangles, whose normals say little once two faces lie on each other.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/mesh_distance.h"
#include "rigid_client/body_set.h"

namespace ballast::rigid {

/// Where two surfaces touch.
struct SurfaceContact {
  Vec3 position;  ///< m
  Vec3 normal;    ///< unit, from the second surface into the first
  double depth;   ///< m, > 0
};

/// A mesh prepared for contacts: what can touch (vertices, convex edges) with the neighbours that say in which
/// directions it can. Closed surface, counter-clockwise seen from outside.
class MeshSurface {
 public:
  explicit MeshSurface(TriangleMesh mesh);

  struct Edge {
    std::uint32_t from, to;                 // vertices
    std::array<std::uint32_t, 2> opposite;  // third vertices of its two triangles
    Vec3 outward;                           // sum of the two normals
  };
  struct Face {
    std::array<Vec3, 3> corners;  // m
    Vec3 normal;                  // unit, outwards
    // Every vertex and every convex edge belongs to one of its triangles, so that a pair is met once; kNone: another's.
    std::array<std::uint32_t, 3> vertices, edges;
    std::array<bool, 3> concave;  // edges, from each corner to the next
  };
  static constexpr std::uint32_t kNone = 0xffffffff;

  const std::vector<Face>& faces() const { return faces_; }
  const Edge& edge(std::uint32_t e) const { return edges_[e]; }
  const Vec3& vertex(std::uint32_t v) const { return mesh_.vertices[v]; }
  const geometry::MeshDistance& distance() const { return distance_; }
  /// Whether nothing next to the vertex or edge lies farther out in `direction` (unit, own frame).
  bool vertex_leads(std::uint32_t v, const Vec3& direction) const;
  bool edge_leads(const Edge& edge, const Vec3& direction) const;
  const Vec3& low() const { return low_; }
  const Vec3& high() const { return high_; }
  double least_extent() const { return (high_ - low_).minCoeff(); }

 private:
  void make_edges();
  void make_neighbours();
  bool is_behind(std::uint32_t v, std::uint32_t neighbour, const Vec3& direction) const;

  TriangleMesh mesh_;
  geometry::MeshDistance distance_;
  std::vector<Face> faces_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_neighbour_,
      neighbours_;  // of vertex v: [first_neighbour_[v], first_neighbour_[v+1])
  Vec3 low_, high_;
};

struct PlacedSurface {
  const MeshSurface* surface;
  Vec3 position;     ///< m, world
  Quat orientation;  ///< unit
};

/// At most a dozen contacts, spread over positions and normals. `reach`: how deep they may be, m; `slop`: differences
/// of depth that mean nothing, m. Appends to `out`.
void find_contacts(const PlacedSurface& a, const PlacedSurface& b, double reach, double slop,
                   std::vector<SurfaceContact>& out);

}  // namespace ballast::rigid
