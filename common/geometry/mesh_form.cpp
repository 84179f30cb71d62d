// Closed triangle meshes as solids; in dimension 2 their section at y = 0, kept as walls along y without ends.
#include <algorithm>
#include <map>

#include "common/geometry/form.h"
#include "common/geometry/general_samples.h"
#include "common/geometry/mesh_distance.h"
#include "common/geometry/mesh_file.h"

namespace ballast::geometry {
namespace {

class MeshForm : public Form {
 public:
  MeshForm(TriangleMesh mesh, const MassProperties& mass, int dimension)
      : mesh_(std::move(mesh)), tree_(mesh_), mass_(mass), dimension_(dimension) {
    bounds_ = {mesh_.vertices.front(), mesh_.vertices.front()};
    for (const Vec3& v : mesh_.vertices) {
      bounds_.min = bounds_.min.cwiseMin(v);
      bounds_.max = bounds_.max.cwiseMax(v);
    }
  }
  MassProperties mass_properties() const override { return mass_; }
  double distance(const Vec3& p) const override { return tree_.nearest(p).distance; }
  Vec3 normal(const Vec3& p) const override {
    const MeshDistance::Nearest on = tree_.nearest(p);
    const Vec3 arm = (p - on.point) * (on.distance < 0 ? -1.0 : 1.0);
    // On the surface itself the arm is only rounding.
    return std::abs(on.distance) > 1e-9 * (bounds_.max - bounds_.min).maxCoeff() ? Vec3(arm.normalized()) : on.normal;
  }
  Box3 bounds() const override { return bounds_; }
  TriangleMesh surface() const override { return mesh_; }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    return general_samples(*this, dimension_, request);
  }

 private:
  TriangleMesh mesh_;
  MeshDistance tree_;
  MassProperties mass_;
  Box3 bounds_;
  int dimension_;
};

// One side of a section with the solid to its left when y points at the viewer's back.
struct Side {
  Vec3 from, to;
};

// Where the mesh crosses y = 0, one side per triangle. Vertices on the plane count as above it, so that every crossing
// triangle has exactly two crossing edges; ends come from sorted edges, so that neighbours share them to the last bit.
std::vector<Side> section(const TriangleMesh& mesh) {
  const auto above = [&](std::uint32_t v) { return mesh.vertices[v].y() >= 0; };
  const auto crossing = [&](std::uint32_t u, std::uint32_t v) -> Vec3 {
    const Vec3 &a = mesh.vertices[std::min(u, v)], &b = mesh.vertices[std::max(u, v)];
    Vec3 p = a + a.y() / (a.y() - b.y()) * (b - a);
    p.y() = 0;
    return p;
  };
  std::vector<Side> sides;
  for (const auto& t : mesh.triangles) {
    Side side;
    bool crosses = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t u = t[k], v = t[(k + 1) % 3];
      if (above(u) == above(v)) continue;
      crosses = true;
      (above(u) ? side.from : side.to) = crossing(u, v);
    }
    if (crosses && side.from != side.to) sides.push_back(side);
  }
  return sides;
}

Result<FormPtr> make_section(const TriangleMesh& mesh) {
  const std::vector<Side> sides = section(mesh);
  if (sides.empty()) {
    return Error{"the mesh does not cross the plane y = 0 of a two-dimensional scene", "move the mesh across y = 0", "",
                 kBadInput};
  }
  const Vec3 half(0, 0.5, 0), apex = sides.front().from;
  TriangleMesh walls, closed;
  for (const auto& [from, to] : sides) {
    const auto base = static_cast<std::uint32_t>(walls.vertices.size());
    for (const Vec3& v : {Vec3(from - half), Vec3(to - half), Vec3(to + half), Vec3(from + half)})
      walls.vertices.push_back(v);
    walls.triangles.push_back({base, base + 1, base + 2});
    walls.triangles.push_back({base, base + 2, base + 3});
  }
  // Ends as fans of signed triangles from one apex: they may overlap, but integrals over them are exact.
  closed = walls;
  for (const auto& [from, to] : sides) {
    for (const double end : {-1.0, 1.0}) {
      const auto base = static_cast<std::uint32_t>(closed.vertices.size());
      for (const Vec3& v : {apex, from, to}) closed.vertices.push_back(v + end * half);
      closed.triangles.push_back({base, base + (end < 0 ? 2U : 1U), base + (end < 0 ? 1U : 2U)});
    }
  }
  return FormPtr(std::make_unique<MeshForm>(weld(walls), mesh_mass(closed), 2));
}

}  // namespace

Result<FormPtr> make_mesh(TriangleMesh mesh, int dimension) {
  if (dimension == 2) return make_section(mesh);
  const MassProperties mass = mesh_mass(mesh);
  return FormPtr(std::make_unique<MeshForm>(std::move(mesh), mass, 3));
}

}  // namespace ballast::geometry
