// Solids with flat faces along the axes: box, open box, and the half-space below a plane.
#include <cmath>

#include "common/geometry/cells.h"
#include "common/geometry/form.h"
#include "common/geometry/tessellate.h"

namespace ballast::geometry {
namespace {

Eigen::Matrix3d box_inertia(const Vec3& size) {
  const Vec3 s = size.cwiseProduct(size) * (size.prod() / 12);
  return Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y()).asDiagonal();
}

MassProperties box_mass(const Vec3& size, const Vec3& centre) { return {size.prod(), centre, box_inertia(size)}; }

Eigen::Matrix3d parallel_axis(const Vec3& arm) {
  return arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
}

SolidPiece box_piece(const Box3& box) {
  SolidPiece piece;
  piece.pose.position = 0.5 * (box.min + box.max);
  piece.size = box.max - box.min;
  return piece;
}

// Products of three rows of cells.
std::vector<SurfaceSample> product(const std::array<std::vector<Cell>, 3>& rows, double depth) {
  std::vector<SurfaceSample> samples;
  for (const Cell& z : rows[2]) {
    for (const Cell& y : rows[1]) {
      for (const Cell& x : rows[0]) {
        if (!keep_cell(std::max({x.room, y.room, z.room}), std::min({x.outer, y.outer, z.outer}), depth)) continue;
        samples.push_back({Vec3(x.centre, y.centre, z.centre), Vec3::Zero(), 0, x.width * y.width * z.width});
      }
    }
  }
  return samples;
}

class BoxForm : public Form {
 public:
  BoxForm(const Vec3& size, int dimension) : size_(size), half_(0.5 * size), flat_(dimension == 2) {
    if (flat_) {
      size_.y() = 1;
      half_.y() = kInf;
    }
  }
  MassProperties mass_properties() const override { return box_mass(size_, Vec3::Zero()); }
  double distance(const Vec3& p) const override { return box_distance(p, -half_, half_); }
  Box3 bounds() const override { return {-0.5 * size_, 0.5 * size_}; }
  TriangleMesh surface() const override { return box_mesh(bounds()); }
  std::vector<SolidPiece> pieces() const override { return {box_piece(bounds())}; }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    std::array<std::vector<Cell>, 3> rows;
    for (int a = 0; a < 3; ++a) {
      rows[a] = flat_ && a == 1 ? depth_cell(false) : solid_cells(-half_[a], half_[a], request.spacing);
    }
    return product(rows, request.depth);
  }

 private:
  Vec3 size_, half_;
  bool flat_;
};

// The room spans 0..size; walls lie outside of it.
class OpenBoxForm : public Form {
 public:
  OpenBoxForm(const Vec3& inside, double wall, bool lid, int dimension)
      : size_(inside),
        wall_(wall),
        lid_(lid),
        flat_(dimension == 2),
        walls_(open_box_walls(inside, wall, lid, dimension)) {
    room_ = {Vec3::Zero(), inside};
    outer_ = {Vec3::Constant(-wall), inside + Vec3(wall, wall, lid ? wall : 0)};
    if (!lid) room_.max.z() = kInf;
    if (flat_) {
      room_.min.y() = outer_.min.y() = -kInf;
      room_.max.y() = outer_.max.y() = kInf;
    }
  }
  MassProperties mass_properties() const override {
    MassProperties sum;
    for (const Box3& wall : walls_) {
      const double volume = (wall.max - wall.min).prod();
      sum.volume += volume;
      sum.centre += 0.5 * volume * (wall.min + wall.max);
    }
    sum.centre /= sum.volume;
    for (const Box3& wall : walls_) {
      const Vec3 size = wall.max - wall.min;
      sum.inertia += box_inertia(size) + size.prod() * parallel_axis(0.5 * (wall.min + wall.max) - sum.centre);
    }
    return sum;
  }
  double distance(const Vec3& p) const override {
    const double outer = box_distance(p, outer_.min, outer_.max), room = box_distance(p, room_.min, room_.max);
    if (outer <= 0 && room >= 0) return -std::min(-outer, room);
    double nearest = kInf;
    for (const Box3& wall : walls_) nearest = std::min(nearest, box_distance(p, wall.min, wall.max));
    return nearest;
  }
  Box3 bounds() const override {
    Box3 b = outer_;
    if (flat_) b.min.y() = -0.5, b.max.y() = 0.5;
    return b;
  }
  bool is_container() const override { return true; }
  double room_distance(const Vec3& p) const override { return box_distance(p, room_.min, room_.max); }
  TriangleMesh surface() const override {
    TriangleMesh mesh;
    for (const Box3& wall : walls_) append(mesh, box_mesh(wall));
    return mesh;
  }
  std::vector<SolidPiece> pieces() const override {
    std::vector<SolidPiece> pieces;
    for (const Box3& wall : walls_) pieces.push_back(box_piece(wall));
    return pieces;
  }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    std::array<std::vector<Cell>, 3> rows;
    for (int a = 0; a < 3; ++a) {
      rows[a] =
          flat_ && a == 1 ? depth_cell(true) : room_cells(0, size_[a], request.spacing, wall_, true, a != 2 || lid_);
    }
    return product(rows, request.depth);
  }

 private:
  Vec3 size_;
  double wall_;
  bool lid_, flat_;
  std::vector<Box3> walls_;
  Box3 room_, outer_;
};

class PlaneForm : public Form {
 public:
  PlaneForm(const Vec3& normal, int dimension) : normal_(normal.normalized()), flat_(dimension == 2) {
    // Tangents along the axes where the plane allows, so that its samples line up with a lattice of fluid.
    int least = 0;
    for (int a = 1; a < 3; ++a) {
      if (std::abs(normal_[a]) < std::abs(normal_[least])) least = a;
    }
    second_ = flat_ ? Vec3(Vec3::UnitY()) : Vec3(normal_.cross(Vec3::Unit(least)).normalized());
    first_ = second_.cross(normal_).normalized();
  }
  MassProperties mass_properties() const override { return {}; }
  double distance(const Vec3& p) const override { return normal_.dot(p); }
  Vec3 normal(const Vec3&) const override { return normal_; }
  Box3 bounds() const override { return {Vec3::Constant(-kInf), Vec3::Constant(kInf)}; }
  TriangleMesh surface() const override { return {}; }
  std::vector<SolidPiece> pieces() const override {
    SolidPiece piece;
    piece.kind = ShapeKind::kPlane;
    piece.normal = normal_;
    return {piece};
  }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    const double d = request.spacing;
    const Eigen::Vector2d range_first = range(first_, request.window);
    const Eigen::Vector2d range_second = flat_ ? Eigen::Vector2d(0, 0) : range(second_, request.window);
    if (!(range_first.allFinite() && range_second.allFinite())) return {};
    const auto layers = static_cast<int>(std::ceil(request.depth / d * (1 - 1e-9)));
    const auto low = [&](const Eigen::Vector2d& r) { return static_cast<long>(std::floor(r[0] / d - 0.5)); };
    const auto high = [&](const Eigen::Vector2d& r) { return static_cast<long>(std::ceil(r[1] / d)); };
    const double volume = flat_ ? d * d : d * d * d;
    std::vector<SurfaceSample> samples;
    for (int k = 0; k < layers; ++k) {
      for (long j = flat_ ? 0 : low(range_second); j <= (flat_ ? 0 : high(range_second)); ++j) {
        for (long i = low(range_first); i <= high(range_first); ++i) {
          Vec3 p = -(k + 0.5) * d * normal_ + (static_cast<double>(i) + 0.5) * d * first_;
          if (!flat_) p += (static_cast<double>(j) + 0.5) * d * second_;
          if (contains(request.window, p, flat_ ? 2 : 3)) samples.push_back({p, normal_, (k + 0.5) * d, volume});
        }
      }
    }
    return samples;
  }

 private:
  // Smallest and largest coordinate of the window along a direction.
  Eigen::Vector2d range(const Vec3& direction, const Box3& window) const {
    Eigen::Vector2d r(0, 0);
    for (int a = 0; a < 3; ++a) {
      if (std::abs(direction[a]) < 1e-14) continue;
      const double one = direction[a] * window.min[a], other = direction[a] * window.max[a];
      r += Eigen::Vector2d(std::min(one, other), std::max(one, other));
    }
    return r;
  }

  Vec3 normal_, first_, second_;
  bool flat_;
};

}  // namespace

double box_distance(const Vec3& p, const Vec3& lo, const Vec3& hi) {
  const Vec3 q = (lo - p).cwiseMax(p - hi);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

std::vector<Box3> open_box_walls(const Vec3& inside, double wall, bool lid, int dimension) {
  const bool flat = dimension == 2;
  const double y_min = flat ? -0.5 : -wall, y_max = flat ? 0.5 : inside.y() + wall, top = inside.z();
  const double x_min = -wall, x_max = inside.x() + wall;
  std::vector<Box3> walls;
  walls.push_back({{x_min, y_min, -wall}, {x_max, y_max, 0}});
  walls.push_back({{x_min, y_min, 0}, {0, y_max, top}});
  walls.push_back({{inside.x(), y_min, 0}, {x_max, y_max, top}});
  if (!flat) {
    walls.push_back({{0, y_min, 0}, {inside.x(), 0, top}});
    walls.push_back({{0, inside.y(), 0}, {inside.x(), y_max, top}});
  }
  if (lid) walls.push_back({{x_min, y_min, top}, {x_max, y_max, top + wall}});
  return walls;
}

FormPtr make_box(const Vec3& size, int dimension) { return std::make_unique<BoxForm>(size, dimension); }
FormPtr make_open_box(const Vec3& inside, double wall, bool lid, int dimension) {
  return std::make_unique<OpenBoxForm>(inside, wall, lid, dimension);
}
FormPtr make_plane(const Vec3& normal, int dimension) { return std::make_unique<PlaneForm>(normal, dimension); }

}  // namespace ballast::geometry
