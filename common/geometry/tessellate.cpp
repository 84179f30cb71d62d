// Triangle surfaces of the simple shapes.
#include "common/geometry/tessellate.h"

#include <cmath>
#include <numbers>

namespace ballast::geometry {
namespace {

constexpr int kSegments = 48;  // around the axis: chords 0.2 % of the radius inside the circle
constexpr int kLatitudes = 24;

// Index of the first vertex of a ring and how many it has (1 on the axis).
struct Ring {
  std::uint32_t first = 0, count = 0;
  std::uint32_t at(int i) const { return first + (count == 1 ? 0U : static_cast<std::uint32_t>(i % kSegments)); }
};

void join(TriangleMesh& mesh, const Ring& upper, const Ring& lower) {
  for (int i = 0; i < kSegments; ++i) {
    if (lower.count > 1) mesh.triangles.push_back({upper.at(i), lower.at(i), lower.at(i + 1)});
    if (upper.count > 1) mesh.triangles.push_back({upper.at(i), lower.at(i + 1), upper.at(i + 1)});
  }
}

}  // namespace

TriangleMesh box_mesh(const Box3& box) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1 ? box.max : box.min).x(), (i & 2 ? box.max : box.min).y(),
                               (i & 4 ? box.max : box.min).z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TriangleMesh revolved(const std::vector<std::array<double, 2>>& profile, bool closed) {
  TriangleMesh mesh;
  std::vector<Ring> rings;
  for (const auto& [radius, z] : profile) {
    const std::uint32_t count = radius > 0 ? kSegments : 1;
    rings.push_back({static_cast<std::uint32_t>(mesh.vertices.size()), count});
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSegments;
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) join(mesh, rings[k], rings[k + 1]);
  if (closed) join(mesh, rings.back(), rings.front());
  return mesh;
}

std::vector<std::array<double, 2>> round_profile(double radius, double half_length) {
  std::vector<std::array<double, 2>> profile;
  for (int i = 0; i <= kLatitudes; ++i) {
    const double angle = std::numbers::pi * (0.5 - static_cast<double>(i) / kLatitudes);
    const bool pole = i == 0 || i == kLatitudes;
    const double shift = 2 * i <= kLatitudes ? half_length : -half_length;
    profile.push_back({pole ? 0.0 : radius * std::cos(angle), radius * std::sin(angle) + shift});
    if (2 * i == kLatitudes && half_length > 0) profile.push_back({radius, -half_length});
  }
  return profile;
}

void append(TriangleMesh& mesh, const TriangleMesh& other, bool inside_out) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (auto [a, b, c] : other.triangles) {
    if (inside_out) std::swap(b, c);
    mesh.triangles.push_back({base + a, base + b, base + c});
  }
}

void turn_z_to_y(TriangleMesh& mesh) {
  for (Vec3& v : mesh.vertices) v = Vec3(v.x(), v.z(), -v.y());
}

}  // namespace ballast::geometry
