// A mesh prepared for contacts: owners of vertices and edges, neighbours.
#include <algorithm>
#include <map>
#include <set>

#include "rigid_client/mesh_contacts.h"

namespace ballast::rigid {

namespace {

// Sine of the angle by which a feature may fail to lead: faces that lie on each other are never quite parallel, and a
// point too many costs nothing, because it is a true point at its true depth.
constexpr double kLean = 0.05;
constexpr double kFlat = 1e-6;  // edges bent less than this are inside a face

}  // namespace

MeshSurface::MeshSurface(TriangleMesh mesh) : mesh_(std::move(mesh)), distance_(mesh_) {
  low_ = high_ = mesh_.vertices.front();
  for (const Vec3& v : mesh_.vertices) {
    low_ = low_.cwiseMin(v);
    high_ = high_.cwiseMax(v);
  }
  std::vector<bool> owned(mesh_.vertices.size(), false);
  for (const auto& t : mesh_.triangles) {
    Face face;
    for (std::size_t k = 0; k < 3; ++k) {
      face.corners[k] = mesh_.vertices[t[k]];
      face.vertices[k] = owned[t[k]] ? kNone : t[k];
      face.edges[k] = kNone;
      face.concave[k] = false;
      owned[t[k]] = true;
    }
    const auto& [a, b, c] = face.corners;
    face.normal = (b - a).cross(c - a).normalized();
    faces_.push_back(face);
  }
  make_edges();
  make_neighbours();
}

void MeshSurface::make_edges() {
  struct Side {
    std::size_t triangle, corner;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Side> open;
  for (std::size_t t = 0; t < faces_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& own = mesh_.triangles[t];
      const std::uint32_t from = own[k], to = own[(k + 1) % 3];
      const auto [it, first] = open.try_emplace(std::minmax(from, to), Side{t, k});
      if (first) continue;
      const Side other = it->second;
      open.erase(it);
      const Edge edge{from,
                      to,
                      {own[(k + 2) % 3], mesh_.triangles[other.triangle][(other.corner + 2) % 3]},
                      faces_[t].normal + faces_[other.triangle].normal};
      const Vec3 arm = vertex(edge.opposite[0]) - vertex(from);
      const double rise = edge.outward.dot(arm) / arm.norm();
      faces_[t].concave[k] = faces_[other.triangle].concave[other.corner] = rise > kFlat;
      if (rise > -kFlat) continue;  // flat or concave: touches nothing by itself
      faces_[other.triangle].edges[other.corner] = static_cast<std::uint32_t>(edges_.size());
      edges_.push_back(edge);
    }
  }
}

void MeshSurface::make_neighbours() {
  std::vector<std::set<std::uint32_t>> near(mesh_.vertices.size());
  for (const auto& t : mesh_.triangles) {
    for (std::size_t k = 0; k < 3; ++k) near[t[k]].insert({t[(k + 1) % 3], t[(k + 2) % 3]});
  }
  first_neighbour_.push_back(0);
  for (const auto& of_vertex : near) {
    neighbours_.insert(neighbours_.end(), of_vertex.begin(), of_vertex.end());
    first_neighbour_.push_back(static_cast<std::uint32_t>(neighbours_.size()));
  }
}

bool MeshSurface::is_behind(std::uint32_t v, std::uint32_t neighbour, const Vec3& direction) const {
  const Vec3 arm = vertex(neighbour) - vertex(v);
  return direction.dot(arm) <= kLean * arm.norm();
}

bool MeshSurface::vertex_leads(std::uint32_t v, const Vec3& direction) const {
  return std::all_of(neighbours_.begin() + first_neighbour_[v], neighbours_.begin() + first_neighbour_[v + 1],
                     [&](std::uint32_t n) { return is_behind(v, n, direction); });
}

bool MeshSurface::edge_leads(const Edge& edge, const Vec3& direction) const {
  return edge.outward.dot(direction) > 0 && is_behind(edge.from, edge.opposite[0], direction) &&
         is_behind(edge.from, edge.opposite[1], direction);
}

}  // namespace ballast::rigid
