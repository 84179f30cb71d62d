// The scene's models as solids with masses, checked against each other.
#include "common/geometry/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace ballast {
namespace {

constexpr double kAllowedOverlap = 1e-4;  // of the smaller body's size

std::string where(const Place& place) {
  return place.line > 0 ? fmt::format("{}:{}:{}", place.file, place.line, place.column) : place.file;
}

Error refuse(const Model& model, const std::string& what, const std::string& cure) {
  return {fmt::format("model '{}': {}", model.name, what), cure, where(model.place), kBadInput};
}

Result<Body> make_body(const Model& model, const World& world) {
  const bool dynamic = model.motion == Motion::kDynamic;
  if (dynamic && model.shape.kind == ShapeKind::kPlane) {
    return refuse(model, "a plane is infinite and cannot move freely", "make it static, or use a box");
  }
  if (world.dimension == 2 && std::hypot(model.pose.rotation.x(), model.pose.rotation.z()) > 1e-9) {
    return refuse(model, "it is turned out of the x-z plane", "in dimension 2 rotate about y only");
  }
  if (dynamic && !(model.mass > 0) && !(model.density > 0)) {
    return refuse(model, "it moves freely but has neither mass nor density", "give density or mass, or make it static");
  }
  Result<Solid> solid = Solid::make(model.shape, world.dimension, world.spacing, dynamic);
  if (!solid) return refuse(model, solid.error().what, solid.error().cure);
  Body body{std::move(*solid), model.pose, 0, Eigen::Matrix3d::Zero()};
  body.pose.rotation.normalize();
  if (world.dimension == 2) body.pose.position.y() = 0;
  body.pose = body_pose(body.pose, body.solid, model.motion);
  if (dynamic) {
    const MassProperties& unit = body.solid.mass_properties();
    body.mass = model.mass > 0 ? model.mass : model.density * unit.volume;
    body.inertia = body.mass / unit.volume * unit.inertia;
  }
  return body;
}

double size_of(const Body& body) {
  const Box3 b = body.solid.bounds();
  return (b.max - b.min).maxCoeff();
}

Box3 world_bounds(const Body& body) {
  const Box3 b = body.solid.bounds();
  if (!(b.min.allFinite() && b.max.allFinite())) return b;
  const Vec3 half = body.pose.rotation.toRotationMatrix().cwiseAbs() * (0.5 * (b.max - b.min));
  const Vec3 centre = body.pose.position + body.pose.rotation * (0.5 * (b.min + b.max));
  return {centre - half, centre + half};
}

std::set<std::pair<std::string, std::string>> joined_pairs(const Scene& scene) {
  std::set<std::pair<std::string, std::string>> pairs;
  for (const Joint& joint : scene.joints) pairs.insert(std::minmax(joint.parent, joint.child));
  return pairs;
}

Status check_overlaps(const Scene& scene, const std::vector<Body>& bodies) {
  const auto joined = joined_pairs(scene);
  std::vector<Box3> boxes;
  for (const Body& body : bodies) boxes.push_back(world_bounds(body));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Model &a = scene.models[i], &b = scene.models[j];
      // Bodies that nothing can push (walls, driven bodies) may pass through each other.
      if (a.motion != Motion::kDynamic && b.motion != Motion::kDynamic) continue;
      const Vec3 common = boxes[i].max.cwiseMin(boxes[j].max) - boxes[i].min.cwiseMax(boxes[j].min);
      const double size = std::min(size_of(bodies[i]), size_of(bodies[j]));
      // What the bounds share is at least as wide as the overlap is deep: bodies that only touch cost nothing.
      if (common.minCoeff() <= kAllowedOverlap * size || joined.contains(std::minmax(a.name, b.name))) continue;
      const double depth = overlap_depth(bodies[i].solid, bodies[i].pose, bodies[j].solid, bodies[j].pose, size / 16);
      if (depth <= kAllowedOverlap * size) continue;
      return Error{fmt::format("models '{}' and '{}' overlap by {:.4g} m at the start", a.name, b.name, depth),
                   fmt::format("move one of them ('{}' at {}, '{}' at {}), join them, or set world.allow_overlap: true",
                               a.name, where(a.place), b.name, where(b.place)),
                   where(b.place), kBadInput};
    }
  }
  return ok();
}

}  // namespace

Result<std::vector<Body>> make_bodies(const Scene& scene) {
  std::vector<Body> bodies;
  for (const Model& model : scene.models) {
    Result<Body> body = make_body(model, scene.world);
    if (!body) return body.error();
    bodies.push_back(std::move(*body));
  }
  if (!scene.world.allow_overlap) {
    if (const Status overlaps = check_overlaps(scene, bodies); !overlaps) return overlaps.error();
  }
  return bodies;
}

}  // namespace ballast
