// Signed distance to a closed triangle mesh.
#include "common/geometry/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace ballast::geometry {
namespace {

constexpr std::uint32_t kLeaf = 4;

double squared_to_box(const Vec3& p, const Vec3& lo, const Vec3& hi) {
  return (lo - p).cwiseMax(p - hi).cwiseMax(0.0).squaredNorm();
}

struct OnTriangle {
  Vec3 point;
  int feature;
};

// Nearest point of a triangle by Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5).
OnTriangle nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {a, 4};
  if (d3 >= 0 && d4 <= d3) return {b, 5};
  if (d6 >= 0 && d5 <= d6) return {c, 6};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + d1 / (d1 - d3) * ab, 1};
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), 2};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + d2 / (d2 - d6) * ac, 3};
  const double sum = va + vb + vc;
  return {a + vb / sum * ab + vc / sum * ac, 0};
}

}  // namespace

MeshDistance::MeshDistance(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(2 * order_.size());
  build(0, static_cast<std::uint32_t>(order_.size()));
  for (const std::uint32_t t : order_) {
    const auto& [a, b, c] = mesh_.triangles[t];
    corners_.push_back({mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]});
  }
  make_normals();
}

std::uint32_t MeshDistance::build(std::uint32_t first, std::uint32_t count) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node;
  node.min = Vec3::Constant(std::numeric_limits<double>::infinity());
  node.max = -node.min;
  const auto centre = [&](std::uint32_t t) -> Vec3 {
    const auto& [a, b, c] = mesh_.triangles[t];
    return mesh_.vertices[a] + mesh_.vertices[b] + mesh_.vertices[c];
  };
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const std::uint32_t v : mesh_.triangles[order_[i]]) {
      node.min = node.min.cwiseMin(mesh_.vertices[v]);
      node.max = node.max.cwiseMax(mesh_.vertices[v]);
    }
  }
  node.first = first;
  node.count = count <= kLeaf ? count : 0;
  nodes_.push_back(node);
  if (count <= kLeaf) return index;
  Eigen::Index axis = 0;
  (node.max - node.min).maxCoeff(&axis);
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t s, std::uint32_t t) {
    const double cs = centre(s)[axis], ct = centre(t)[axis];
    return cs < ct || (cs == ct && s < t);
  });
  build(first, half);
  nodes_[index].right = build(first + half, count - half);
  return index;
}

void MeshDistance::make_normals() {
  std::vector<Vec3> at_vertex(mesh_.vertices.size(), Vec3::Zero());
  std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> at_edge;
  normals_.resize(mesh_.triangles.size());
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto& v = mesh_.triangles[t];
    const std::array<Vec3, 3> x{mesh_.vertices[v[0]], mesh_.vertices[v[1]], mesh_.vertices[v[2]]};
    const Vec3 face = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
    normals_[t][0] = face;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
      const Vec3 one = (x[next] - x[k]).normalized(), other = (x[last] - x[k]).normalized();
      at_vertex[v[k]] += std::acos(std::clamp(one.dot(other), -1.0, 1.0)) * face;
      at_edge.try_emplace(std::minmax(v[k], v[next]), Vec3::Zero()).first->second += face;
    }
  }
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    const auto& v = mesh_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      // Features 1, 2, 3 are the edges 0-1, 1-2, 2-0.
      normals_[t][1 + k] = at_edge.at(std::minmax(v[k], v[(k + 1) % 3])).normalized();
      normals_[t][4 + k] = at_vertex[v[k]].normalized();
    }
  }
}

void MeshDistance::visit_leaf(const Node& node, const Vec3& p, Hit& best) const {
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
    const auto& [a, b, c] = corners_[i];
    const OnTriangle on = nearest_on_triangle(p, a, b, c);
    const double squared = (p - on.point).squaredNorm();
    if (squared < best.squared) best = {on.point, squared, order_[i], on.feature};
  }
}

MeshDistance::Nearest MeshDistance::nearest(const Vec3& p, double within) const {
  Hit best{p, within * within * (1 + 1e-12), 0, 0};
  // Depth of the tree is log2 of the triangle count: 64 entries are beyond any 32-bit count.
  std::array<std::pair<std::uint32_t, double>, 64> stack;
  std::size_t size = 0;
  stack[size++] = {0, 0.0};
  while (size > 0) {
    const auto [index, bound] = stack[--size];
    if (bound >= best.squared) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      visit_leaf(node, p, best);
      continue;
    }
    const std::uint32_t left = index + 1, right = node.right;
    const double to_left = squared_to_box(p, nodes_[left].min, nodes_[left].max);
    const double to_right = squared_to_box(p, nodes_[right].min, nodes_[right].max);
    // The nearer child is visited first: pushed last.
    if (to_left < to_right) {
      stack[size++] = {right, to_right};
      stack[size++] = {left, to_left};
    } else {
      stack[size++] = {left, to_left};
      stack[size++] = {right, to_right};
    }
  }
  const Vec3& normal = normals_[best.triangle][static_cast<std::size_t>(best.feature)];
  const double sign = (p - best.point).dot(normal) < 0 ? -1 : 1;
  return {best.point, normal, sign * std::sqrt(best.squared)};
}

void MeshDistance::overlapping(const Vec3& low, const Vec3& high, std::vector<std::uint32_t>& out) const {
  out.clear();
  const auto apart = [&](const Vec3& min, const Vec3& max) {
    return (min.array() > high.array()).any() || (max.array() < low.array()).any();
  };
  std::array<std::uint32_t, 64> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    if (apart(node.min, node.max)) continue;
    if (node.count == 0) {
      stack[size++] = node.right;
      stack[size++] = index + 1;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const auto& [a, b, c] = corners_[i];
      if (!apart(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c))) out.push_back(order_[i]);
    }
  }
}

}  // namespace ballast::geometry
