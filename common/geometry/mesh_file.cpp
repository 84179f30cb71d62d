// Mesh files to checked triangle meshes.
#include "common/geometry/mesh_file.h"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "common/geometry/mesh_reader.h"

namespace ballast::geometry {

Result<TriangleMesh> read_mesh(const std::string& file, const Vec3& scale) {
  if (!scale.allFinite() || scale.cwiseAbs().minCoeff() <= 0) {
    return Error{fmt::format("scale of mesh '{}' is ({}, {}, {})", file, scale.x(), scale.y(), scale.z()),
                 "give finite factors other than 0", "", kBadInput};
  }
  auto read = read_triangles(file);
  if (!read) return read.error();
  TriangleMesh mesh = *std::move(read);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    mesh.vertices[v] = mesh.vertices[v].cwiseProduct(scale);
    if (!mesh.vertices[v].allFinite())
      return Error{fmt::format("vertex {} of mesh '{}' is not finite", v, file), "repair the mesh", "", kBadInput};
  }
  if (scale.prod() < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);  // mirrored
  mesh = weld(mesh);
  const auto name_file = [&](Error error) {
    return error.what = fmt::format("mesh '{}': {}", file, error.what), error;
  };
  if (const Status closed = check_closed(mesh); !closed) return name_file(closed.error());
  return mesh;
}

TriangleMesh weld(const TriangleMesh& mesh) {
  TriangleMesh out;
  std::map<std::array<double, 3>, std::uint32_t> seen;
  const auto index = [&](std::uint32_t v) {
    const Vec3& p = mesh.vertices[v];
    // + 0.0 turns -0 into 0.
    const auto [it, fresh] = seen.try_emplace({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, out.vertices.size());
    if (fresh) out.vertices.push_back(p);
    return it->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::uint32_t, 3> t{index(a), index(b), index(c)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) out.triangles.push_back(t);
  }
  return out;
}

Status check_closed(const TriangleMesh& mesh) {
  const auto refuse = [](std::string what, std::string cure) -> Status {
    return Error{std::move(what), std::move(cure), "", kBadInput};
  };
  if (mesh.triangles.empty()) return refuse("no triangles in it", "give a closed surface with an inside");
  // Every directed edge needs exactly as many opposite ones.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  std::size_t open = 0;
  const Vec3* at = nullptr;
  for (const auto& [edge, sum] : balance) {
    if (sum == 0) continue;
    ++open;
    if (!at) at = &mesh.vertices[edge.first];
  }
  if (open > 0) {
    return refuse(
        fmt::format("the surface is open: {} of {} edges lack a partner, the first near ({:.6g}, {:.6g}, {:.6g})", open,
                    balance.size(), at->x(), at->y(), at->z()),
        "close the holes, weld the vertices and make all triangles turn the same way");
  }
  const double volume = mesh_mass(mesh).volume;
  if (volume < 0) {
    return refuse(fmt::format("the surface is inside out: its volume is {:.6g} m^3", volume),
                  "flip its triangles: counter-clockwise seen from outside");
  }
  const Vec3 first = mesh.vertices.front();
  double size = 0;
  for (const Vec3& v : mesh.vertices) size = std::max(size, (v - first).norm());
  if (volume < 1e-12 * size * size * size)
    return refuse("the surface encloses no volume", "give a solid with a thickness");
  return ok();
}

MassProperties mesh_mass(const TriangleMesh& mesh) {
  // Signed tetrahedra from the first vertex, which keeps rounding small for meshes far from the origin. For a
  // tetrahedron with apex 0: integral of x x^T = volume / 20 (s s^T + a a^T + b b^T + c c^T), s = a + b + c.
  MassProperties mass;
  const Vec3 apex = mesh.vertices.front();
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - apex, b = mesh.vertices[t[1]] - apex, c = mesh.vertices[t[2]] - apex,
               s = a + b + c;
    const double volume = a.dot(b.cross(c)) / 6;
    mass.volume += volume;
    first += volume / 4 * s;
    second += volume / 20 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vec3 arm = first / mass.volume;
  mass.centre = apex + arm;
  second -= mass.volume * arm * arm.transpose();
  mass.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return mass;
}

}  // namespace ballast::geometry
