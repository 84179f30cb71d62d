// Solid: one Form moved to the body frame, checked on the way in.
#include "common/geometry/solid.h"

#include <fmt/format.h>

#include <cmath>

#include "common/geometry/form.h"
#include "common/geometry/mesh_file.h"

namespace ballast {

struct Solid::Data {
  geometry::FormPtr form;
  int dimension = 3;
  MassProperties mass;
  Vec3 origin = Vec3::Zero();  // of the body frame, in the model's frame

  // Body frame -> model's frame; in dimension 2 onto the plane.
  Vec3 to_model(const Vec3& p) const {
    Vec3 q = p + origin;
    if (dimension == 2) q.y() = 0;
    return q;
  }
};

namespace geometry {
namespace {

Error bad_size(const char* shape, const char* what, double value) {
  return {fmt::format("{} of a {} is {} m", what, shape, value), "give a finite length above 0", "", kBadInput};
}

bool good(double length) { return std::isfinite(length) && length > 0; }

// Which lengths a shape must have; the first bad one is reported.
Status check_sizes(const Shape& s, int dimension) {
  const bool box = s.kind == ShapeKind::kBox, open_box = s.kind == ShapeKind::kOpenBox;
  const bool round = s.kind == ShapeKind::kSphere || s.kind == ShapeKind::kCylinder || s.kind == ShapeKind::kCapsule;
  const bool flat = dimension == 2;
  for (int a = 0; a < 3 && (box || open_box); ++a) {
    if (flat && a == 1) continue;
    if (!good(s.size[a])) {
      constexpr const char* kEdges[] = {"edge along x", "edge along y", "edge along z"};
      return bad_size(box ? "box" : "open box", kEdges[a], s.size[a]);
    }
  }
  const char* name = s.kind == ShapeKind::kSphere ? "sphere" : s.kind == ShapeKind::kCylinder ? "cylinder" : "capsule";
  if (round && !good(s.radius)) return bad_size(name, "radius", s.radius);
  if (round && s.kind != ShapeKind::kSphere && !flat && !good(s.length)) return bad_size(name, "length", s.length);
  if (!std::isfinite(s.wall) || s.wall < 0) return bad_size("container", "wall", s.wall);
  if (s.kind == ShapeKind::kPlane) {
    const Vec3 n = flat ? Vec3(s.normal.x(), 0, s.normal.z()) : s.normal;
    if (!n.allFinite() || n.norm() < 1e-12) {
      return Error{fmt::format("normal of a plane is ({}, {}, {})", s.normal.x(), s.normal.y(), s.normal.z()),
                   flat ? "give a direction in the x-z plane" : "give a direction, for example [0, 0, 1]", "",
                   kBadInput};
    }
  }
  return ok();
}

}  // namespace

double wall_thickness(const Shape& shape, double spacing) {
  if (shape.wall > 0) return shape.wall;
  if (spacing > 0) return 3 * spacing;
  return 0.05 * std::max({shape.size.maxCoeff(), 2 * shape.radius, shape.length});
}

Result<FormPtr> make_form(const Shape& shape, int dimension, double spacing) {
  if (const Status sizes = check_sizes(shape, dimension); !sizes) return sizes.error();
  const double wall = shape.hollow ? wall_thickness(shape, spacing) : 0;
  switch (shape.kind) {
    case ShapeKind::kBox:
      return make_box(shape.size, dimension);
    case ShapeKind::kOpenBox:
      return make_open_box(shape.size, wall_thickness(shape, spacing), shape.lid, dimension);
    case ShapeKind::kPlane:
      return make_plane(dimension == 2 ? Vec3(shape.normal.x(), 0, shape.normal.z()) : shape.normal, dimension);
    case ShapeKind::kSphere:
      return make_ball(shape.radius, wall, dimension);
    case ShapeKind::kCylinder:
      return dimension == 2 ? make_ball(shape.radius, wall, 2) : make_cylinder(shape.radius, shape.length, wall);
    case ShapeKind::kCapsule:
      return dimension == 2 ? make_ball(shape.radius, 0, 2) : make_capsule(shape.radius, shape.length);
    case ShapeKind::kMesh: {
      Result<TriangleMesh> mesh = read_mesh(shape.mesh, shape.scale);
      if (!mesh) return mesh.error();
      return make_mesh(std::move(*mesh), dimension);
    }
    case ShapeKind::kCompound:
      return make_compound(shape.parts, dimension, spacing);
  }
  return Error{"unknown kind of shape", "use one of the shapes of the scene reference", "", kBadInput};
}

Vec3 Form::normal(const Vec3& p) const {
  const double scale = std::max(1e-3, (bounds().max - bounds().min).cwiseMin(1e3).maxCoeff());
  // On a medial line the two sides cancel; a small, lopsided step off it chooses one of them, always the same.
  for (const double shift : {0.0, 1e-5 * scale, 1e-3 * scale}) {
    const Vec3 at = p + shift * Vec3(0.8, 0.53, 0.29);
    Vec3 gradient;
    for (int a = 0; a < 3; ++a) {
      const Vec3 step = 1e-6 * scale * Vec3::Unit(a);
      gradient[a] = (distance(at + step) - distance(at - step)) / (2e-6 * scale);
    }
    if (gradient.norm() > 0.6) return gradient.normalized();
  }
  return Vec3::UnitZ();
}

std::vector<SolidPiece> Form::pieces() const {
  SolidPiece piece;
  piece.kind = ShapeKind::kMesh;
  piece.mesh = surface();
  return {piece};
}

}  // namespace geometry

Solid::Solid(std::unique_ptr<const Data> data) : data_(std::move(data)) {}
Solid::Solid(Solid&&) noexcept = default;
Solid& Solid::operator=(Solid&&) noexcept = default;
Solid::~Solid() = default;

Result<Solid> Solid::make(const Shape& shape, int dimension, double spacing, bool centre_on_mass) {
  Result<geometry::FormPtr> form = geometry::make_form(shape, dimension, spacing);
  if (!form) return form.error();
  auto data = std::make_unique<Data>();
  data->form = std::move(*form);
  data->dimension = dimension;
  data->mass = data->form->mass_properties();
  if (centre_on_mass) data->origin = data->mass.centre;
  return Solid(std::move(data));
}

const MassProperties& Solid::mass_properties() const { return data_->mass; }
double Solid::distance(const Vec3& point) const { return data_->form->distance(data_->to_model(point)); }
Vec3 Solid::normal(const Vec3& point) const { return data_->form->normal(data_->to_model(point)); }
bool Solid::is_container() const { return data_->form->is_container(); }
double Solid::room_distance(const Vec3& point) const { return data_->form->room_distance(data_->to_model(point)); }

Box3 Solid::bounds() const {
  const Box3 b = data_->form->bounds();
  return {b.min - data_->origin, b.max - data_->origin};
}

std::vector<SurfaceSample> Solid::samples(double spacing, double depth, const Box3& window) const {
  const Data& d = *data_;
  const Box3 shifted{window.min + d.origin, window.max + d.origin};
  std::vector<SurfaceSample> samples = d.form->samples({spacing, depth, shifted});
  std::erase_if(samples, [&](const SurfaceSample& s) { return !geometry::contains(shifted, s.position, d.dimension); });
  for (SurfaceSample& s : samples) {
    s.depth = -d.form->distance(s.position);
    s.normal = d.form->normal(s.position);
    s.position -= d.origin;
  }
  return samples;
}

TriangleMesh Solid::surface() const {
  TriangleMesh mesh = data_->form->surface();
  for (Vec3& v : mesh.vertices) v -= data_->origin;
  return mesh;
}

std::vector<SolidPiece> Solid::pieces() const {
  std::vector<SolidPiece> pieces = data_->form->pieces();
  for (SolidPiece& piece : pieces) piece.pose.position -= data_->origin;
  return pieces;
}

int Solid::dimension() const { return data_->dimension; }

Pose body_pose(const Pose& model_pose, const Solid& solid, Motion motion) {
  if (motion != Motion::kDynamic) return model_pose;
  return {model_pose.position + model_pose.rotation * solid.mass_properties().centre, model_pose.rotation};
}

}  // namespace ballast
