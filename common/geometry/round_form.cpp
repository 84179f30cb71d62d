// Solids of revolution: sphere and disc, cylinder, capsule, and the rooms inside hollow spheres and cylinders.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/geometry/cells.h"
#include "common/geometry/form.h"
#include "common/geometry/tessellate.h"

namespace ballast::geometry {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGoldenAngle = 2.39996322972865332;  // rad, pi (3 - sqrt 5)

double ball_volume(double r) { return 4.0 / 3.0 * kPi * r * r * r; }

// Volume and the two moments of inertia of a cylinder about its centre, unit density.
struct CylinderMass {
  double volume, axial, across;
  CylinderMass(double r, double l)
      : volume(kPi * r * r * l), axial(0.5 * volume * r * r), across(volume * (3 * r * r + l * l) / 12) {}
};

// Cells along the radius, about `pitch` wide.
std::vector<Cell> radius_cells(double radius, double pitch) {
  std::vector<Cell> cells = solid_cells(0, radius, pitch);
  for (Cell& c : cells) c.outer = radius - (c.centre + 0.5 * c.width);
  return cells;
}
// Of a solid. Of more than a spacing there are two at least: one alone would lie so deep that the fluid hardly feels
// it.
std::vector<Cell> solid_radius(double radius, double spacing) {
  return radius_cells(radius, radius > spacing ? std::min(spacing, radius / 2) : spacing);
}
// Of a room and its wall.
std::vector<Cell> room_radius(double radius, double wall, double spacing) {
  std::vector<Cell> cells = radius_cells(radius, spacing);
  for (Cell& c : cells) c.room = -1, c.outer += wall;
  const double pitch = wall / cell_count(wall, spacing);
  for (double at = radius; at < radius + wall - 0.5 * pitch; at += pitch) {
    cells.push_back({at + 0.5 * pitch, pitch, at - radius, radius + wall - (at + pitch)});
  }
  return cells;
}

// A sample stands at the centroid of the piece of its layer that it stands for, or the body that the fluid feels would
// be smaller than it is, by d^2 / (12 R^2) of a cylinder. Mean radius of a layer:
double ring_mean(const Cell& c) {
  const double lo = c.centre - 0.5 * c.width, hi = c.centre + 0.5 * c.width;
  return 2.0 / 3.0 * (hi * hi + hi * lo + lo * lo) / (hi + lo);
}
double shell_mean(const Cell& c) {
  const double lo = c.centre - 0.5 * c.width, hi = c.centre + 0.5 * c.width;
  return 0.75 * (hi + lo) * (hi * hi + lo * lo) / (hi * hi + hi * lo + lo * lo);
}
// Mean cosine over a piece: of an arc of half an angle `half`, and of a round piece of a unit sphere.
double arc_mean(double half) { return std::sin(half) / half; }
double cap_mean(double area) { return std::max(0.0, 1 - area / (4 * kPi)); }

// Points spread evenly over a circle of the x-y plane; one alone is its centre.
std::vector<Vec3> circle_points(const Cell& ring, std::size_t index, double spacing) {
  const int n = std::max(1, static_cast<int>(std::lround(2 * kPi * ring.centre / spacing)));
  if (n == 1) return {Vec3::Zero()};
  const double r = ring_mean(ring) * arc_mean(kPi / n);
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kPi * (i + 0.5 * static_cast<double>(index % 2)) / n;
    points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
  }
  return points;
}

// The same over a shell about the axis from -half to half (half = 0: a sphere), on a Fibonacci spiral. Zones of equal
// height have equal area on the caps as on the middle (Archimedes), so z advances evenly along the whole spiral.
std::vector<Vec3> shell_points(const Cell& shell, double half, double spacing) {
  const double r = shell.centre, area = 4 * kPi * r * (r + half), height = 2 * (r + half);
  // A shell thinner than the spacing still has its length to fill.
  const long along = half > 0 ? std::lround(height / spacing) : 1;
  const long n = std::max({1L, along, std::lround(area / (spacing * spacing))});
  if (n == 1) return {Vec3::Zero()};
  const double piece = area / static_cast<double>(n) / (r * r);  // on a unit radius
  const double on_cap = shell_mean(shell) * cap_mean(piece);
  const double between = ring_mean(shell) * arc_mean(std::min(kPi, 0.5 * std::sqrt(piece)));
  std::vector<Vec3> points;
  for (long i = 0; i < n; ++i) {
    const double z = 0.5 * height * (1 - (2 * static_cast<double>(i) + 1.0) / static_cast<double>(n));
    const double above = std::max(0.0, std::abs(z) - half) / r, rho = std::sqrt(std::max(0.0, 1 - above * above));
    const double angle = kGoldenAngle * static_cast<double>(i), out = rho * (above > 0 ? on_cap : between);
    points.emplace_back(out * std::cos(angle), out * std::sin(angle),
                        std::copysign(std::min(std::abs(z), half) + on_cap * above, z));
  }
  return points;
}

double ring_area(const Cell& ring) { return 2 * kPi * ring.centre * ring.width; }

SolidPiece round_piece(ShapeKind kind, double radius, double length) {
  SolidPiece piece;
  piece.kind = kind;
  piece.radius = radius;
  piece.length = length;
  return piece;
}

class BallForm : public Form {
 public:
  BallForm(double radius, double wall, int dimension)
      : radius_(radius), wall_(wall), outer_(radius + wall), flat_(dimension == 2) {}
  MassProperties mass_properties() const override {
    MassProperties mass;
    const double inner = wall_ > 0 ? radius_ : 0;
    if (flat_) {
      const CylinderMass whole(outer_, 1), hole(inner, 1);
      const double across = whole.across - hole.across;
      mass.volume = whole.volume - hole.volume;
      mass.inertia = Vec3(across, whole.axial - hole.axial, across).asDiagonal();
    } else {
      mass.volume = ball_volume(outer_) - ball_volume(inner);
      mass.inertia = 0.4 * (ball_volume(outer_) * outer_ * outer_ - ball_volume(inner) * inner * inner) *
                     Eigen::Matrix3d::Identity();
    }
    return mass;
  }
  double distance(const Vec3& p) const override {
    const double r = p.norm();
    return wall_ > 0 ? std::abs(r - radius_ - 0.5 * wall_) - 0.5 * wall_ : r - radius_;
  }
  Vec3 normal(const Vec3& p) const override {
    const double r = p.norm();
    const Vec3 out = r > 0 ? Vec3(p / r) : Vec3(Vec3::UnitZ());
    return wall_ > 0 && r < radius_ + 0.5 * wall_ ? Vec3(-out) : out;
  }
  Box3 bounds() const override {
    Box3 b{Vec3::Constant(-outer_), Vec3::Constant(outer_)};
    if (flat_) b.min.y() = -0.5, b.max.y() = 0.5;
    return b;
  }
  bool is_container() const override { return wall_ > 0; }
  double room_distance(const Vec3& p) const override { return wall_ > 0 ? p.norm() - radius_ : kInf; }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    const auto cells =
        wall_ > 0 ? room_radius(radius_, wall_, request.spacing) : solid_radius(radius_, request.spacing);
    std::vector<SurfaceSample> samples;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const Cell& c = cells[k];
      if (!keep_cell(c.room, c.outer, request.depth)) continue;
      const auto points = flat_ ? circle_points(c, k, request.spacing) : shell_points(c, 0, request.spacing);
      const double hi = c.centre + 0.5 * c.width, lo = c.centre - 0.5 * c.width;
      const double volume = flat_ ? ring_area(c) : ball_volume(hi) - ball_volume(lo);
      const double share = volume / static_cast<double>(points.size());
      for (const Vec3& p : points) {
        samples.push_back({flat_ ? Vec3(p.x(), 0, p.y()) : p, Vec3::Zero(), 0, share});
      }
    }
    return samples;
  }
  std::vector<SolidPiece> pieces() const override {
    if (wall_ > 0) return Form::pieces();
    if (!flat_) return {round_piece(ShapeKind::kSphere, radius_, 0)};
    SolidPiece disc = round_piece(ShapeKind::kCylinder, radius_, 1);
    disc.pose.rotation = z_to_y();
    return {disc};
  }
  TriangleMesh surface() const override {
    TriangleMesh mesh;
    if (flat_) {
      if (wall_ > 0) {
        mesh = revolved({{outer_, 0.5}, {outer_, -0.5}, {radius_, -0.5}, {radius_, 0.5}}, true);
      } else {
        mesh = revolved({{0, 0.5}, {outer_, 0.5}, {outer_, -0.5}, {0, -0.5}}, false);
      }
      turn_z_to_y(mesh);
      return mesh;
    }
    mesh = revolved(round_profile(outer_, 0), false);
    if (wall_ > 0) append(mesh, revolved(round_profile(radius_, 0), false), true);
    return mesh;
  }

 private:
  double radius_, wall_, outer_;
  bool flat_;
};

class CylinderForm : public Form {
 public:
  CylinderForm(double radius, double length, double wall)
      : radius_(radius), half_(0.5 * length), wall_(wall), outer_radius_(radius + wall), outer_half_(half_ + wall) {}
  MassProperties mass_properties() const override {
    const CylinderMass whole(outer_radius_, 2 * outer_half_), hole(wall_ > 0 ? radius_ : 0, 2 * half_);
    const double across = whole.across - hole.across;
    return {whole.volume - hole.volume, Vec3::Zero(), Vec3(across, across, whole.axial - hole.axial).asDiagonal()};
  }
  double distance(const Vec3& p) const override {
    const double outer = plain(p, outer_radius_, outer_half_);
    return wall_ > 0 ? std::max(outer, -plain(p, radius_, half_)) : outer;
  }
  Box3 bounds() const override {
    const Vec3 corner(outer_radius_, outer_radius_, outer_half_);
    return {-corner, corner};
  }
  bool is_container() const override { return wall_ > 0; }
  double room_distance(const Vec3& p) const override { return wall_ > 0 ? plain(p, radius_, half_) : kInf; }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    const double d = request.spacing;
    const auto rings = wall_ > 0 ? room_radius(radius_, wall_, d) : solid_radius(radius_, d);
    const auto slices = wall_ > 0 ? room_cells(-half_, half_, d, wall_, true, true) : solid_cells(-half_, half_, d);
    std::vector<SurfaceSample> samples;
    for (const Cell& slice : slices) {
      for (std::size_t k = 0; k < rings.size(); ++k) {
        const Cell& ring = rings[k];
        if (!keep_cell(std::max(ring.room, slice.room), std::min(ring.outer, slice.outer), request.depth)) continue;
        const auto points = circle_points(ring, k, d);
        const double share = ring_area(ring) * slice.width / static_cast<double>(points.size());
        for (const Vec3& p : points) samples.push_back({p + slice.centre * Vec3::UnitZ(), Vec3::Zero(), 0, share});
      }
    }
    return samples;
  }
  std::vector<SolidPiece> pieces() const override {
    if (wall_ > 0) return Form::pieces();
    return {round_piece(ShapeKind::kCylinder, radius_, 2 * half_)};
  }
  TriangleMesh surface() const override {
    const auto profile = [](double r, double h) {
      return std::vector<std::array<double, 2>>{{0, h}, {r, h}, {r, -h}, {0, -h}};
    };
    TriangleMesh mesh = revolved(profile(outer_radius_, outer_half_), false);
    if (wall_ > 0) append(mesh, revolved(profile(radius_, half_), false), true);
    return mesh;
  }

 private:
  // Signed distance to a solid cylinder about the origin.
  static double plain(const Vec3& p, double radius, double half) {
    const double across = std::hypot(p.x(), p.y()) - radius, along = std::abs(p.z()) - half;
    return std::hypot(std::max(across, 0.0), std::max(along, 0.0)) + std::min(std::max(across, along), 0.0);
  }
  double radius_, half_, wall_, outer_radius_, outer_half_;
};

class CapsuleForm : public Form {
 public:
  CapsuleForm(double radius, double length) : radius_(radius), half_(0.5 * length) {}
  MassProperties mass_properties() const override {
    // Cylinder and two half balls; a half ball's centre lies 3/8 radius from its flat face.
    const CylinderMass middle(radius_, 2 * half_);
    const double caps = ball_volume(radius_), r2 = radius_ * radius_;
    const double across = middle.across + caps * (0.4 * r2 + half_ * half_ + 0.75 * half_ * radius_);
    return {middle.volume + caps, Vec3::Zero(), Vec3(across, across, middle.axial + 0.4 * caps * r2).asDiagonal()};
  }
  double distance(const Vec3& p) const override { return (p - axis_point(p)).norm() - radius_; }
  Vec3 normal(const Vec3& p) const override {
    const Vec3 arm = p - axis_point(p);
    const double r = arm.norm();
    return r > 0 ? Vec3(arm / r) : Vec3(Vec3::UnitX());
  }
  Box3 bounds() const override {
    const Vec3 corner(radius_, radius_, half_ + radius_);
    return {-corner, corner};
  }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    std::vector<SurfaceSample> samples;
    for (const Cell& c : solid_radius(radius_, request.spacing)) {
      if (!keep_cell(c.room, c.outer, request.depth)) continue;
      const auto points = shell_points(c, half_, request.spacing);
      const double whole = volume(c.centre + 0.5 * c.width) - volume(c.centre - 0.5 * c.width);
      for (const Vec3& p : points) samples.push_back({p, Vec3::Zero(), 0, whole / static_cast<double>(points.size())});
    }
    return samples;
  }
  TriangleMesh surface() const override { return revolved(round_profile(radius_, half_), false); }
  std::vector<SolidPiece> pieces() const override { return {round_piece(ShapeKind::kCapsule, radius_, 2 * half_)}; }

 private:
  double volume(double r) const { return ball_volume(r) + kPi * r * r * 2 * half_; }
  Vec3 axis_point(const Vec3& p) const { return {0, 0, std::clamp(p.z(), -half_, half_)}; }
  double radius_, half_;
};

}  // namespace

FormPtr make_ball(double radius, double wall, int dimension) {
  return std::make_unique<BallForm>(radius, wall, dimension);
}
FormPtr make_cylinder(double radius, double length, double wall) {
  return std::make_unique<CylinderForm>(radius, length, wall);
}
FormPtr make_capsule(double radius, double length) { return std::make_unique<CapsuleForm>(radius, length); }

}  // namespace ballast::geometry
