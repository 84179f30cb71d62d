// Bodies and joints of a scene as the plain records that rigid engines read.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/geometry/bodies.h"

namespace ballast {
namespace {

using exchange::BodyRecord;
using exchange::JointRecord;
using exchange::Manifest;
using exchange::ShapeRecord;

void copy(const Vec3& from, double (&to)[3]) { std::copy_n(from.data(), 3, to); }
void copy(const Quat& from, double (&to)[4]) { to[0] = from.w(), to[1] = from.x(), to[2] = from.y(), to[3] = from.z(); }
void copy(const std::string& from, char (&to)[64]) {
  std::memcpy(to, from.data(), std::min<std::size_t>(from.size(), 63));
}

exchange::ShapeType type_of(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::kSphere:
      return exchange::ShapeType::kSphere;
    case ShapeKind::kCylinder:
      return exchange::ShapeType::kCylinder;
    case ShapeKind::kCapsule:
      return exchange::ShapeType::kCapsule;
    case ShapeKind::kPlane:
      return exchange::ShapeType::kPlane;
    case ShapeKind::kMesh:
      return exchange::ShapeType::kMesh;
    case ShapeKind::kBox:
    case ShapeKind::kOpenBox:
    case ShapeKind::kCompound:
      break;  // open boxes and compounds come as their pieces
  }
  return exchange::ShapeType::kBox;
}

void add_shape(const SolidPiece& piece, std::uint32_t body, Manifest& manifest) {
  ShapeRecord r{};
  r.type = type_of(piece.kind);
  r.body = body;
  copy(piece.pose.position, r.position);
  copy(piece.pose.rotation, r.orientation);
  copy(piece.size, r.size);
  r.radius = piece.radius;
  r.length = piece.length;
  copy(Vec3(piece.pose.rotation * piece.normal), r.normal);
  r.first_vertex = static_cast<std::uint32_t>(manifest.vertices.size() / 3);
  r.vertex_count = static_cast<std::uint32_t>(piece.mesh.vertices.size());
  r.first_triangle = static_cast<std::uint32_t>(manifest.triangles.size() / 3);
  r.triangle_count = static_cast<std::uint32_t>(piece.mesh.triangles.size());
  for (const Vec3& v : piece.mesh.vertices) manifest.vertices.insert(manifest.vertices.end(), v.data(), v.data() + 3);
  for (const auto& t : piece.mesh.triangles) manifest.triangles.insert(manifest.triangles.end(), t.begin(), t.end());
  manifest.shapes.push_back(r);
}

exchange::BodyMotion motion_of(Motion motion) {
  switch (motion) {
    case Motion::kStatic:
      return exchange::BodyMotion::kStatic;
    case Motion::kDynamic:
      return exchange::BodyMotion::kDynamic;
    case Motion::kPrescribed:
      break;
  }
  return exchange::BodyMotion::kPrescribed;
}

BodyRecord body_record(const Model& model, const Body& body) {
  BodyRecord r{};
  copy(model.name, r.name);
  r.mass = body.mass;
  const Eigen::Matrix3d& j = body.inertia;
  const double inertia[6] = {j(0, 0), j(1, 1), j(2, 2), j(0, 1), j(0, 2), j(1, 2)};
  std::copy_n(inertia, 6, r.inertia);
  copy(body.pose.position, r.position);
  copy(body.pose.rotation, r.orientation);
  if (model.motion == Motion::kDynamic) {
    copy(model.velocity, r.velocity);
    copy(model.angular_velocity, r.angular_velocity);
  }
  r.friction = model.friction;
  r.restitution = model.restitution;
  r.volume = body.solid.mass_properties().volume;
  r.motion = motion_of(model.motion);
  if (model.motion == Motion::kPrescribed) {
    const Prescription& drive = model.prescription;
    copy(drive.velocity, r.drive_velocity);
    copy(drive.angular_velocity, r.drive_angular_velocity);
    copy(drive.amplitude, r.drive_amplitude);
    r.drive_frequency = drive.frequency;
    r.drive_phase = drive.phase;
    r.drive_start = drive.start;
    r.drive_stop = drive.stop;
  }
  return r;
}

std::int32_t body_index(const Scene& scene, const std::string& name) {
  const auto it =
      std::find_if(scene.models.begin(), scene.models.end(), [&](const Model& m) { return m.name == name; });
  return it == scene.models.end() ? -1 : static_cast<std::int32_t>(it - scene.models.begin());
}

JointRecord joint_record(const Scene& scene, const Joint& joint) {
  constexpr double kFree = std::numeric_limits<double>::infinity();
  JointRecord r{};
  copy(joint.name, r.name);
  copy(joint.anchor, r.anchor);
  copy(joint.axis, r.axis);
  copy(joint.axis2, r.axis2);
  r.lower = joint.lower.value_or(-kFree);
  r.upper = joint.upper.value_or(kFree);
  r.motor_velocity = joint.motor_velocity;
  r.motor_max_effort = joint.motor_max_effort;
  r.spring = joint.spring;
  r.damper = joint.damper;
  r.rest = joint.rest;
  r.type = static_cast<exchange::JointType>(joint.kind);
  r.parent = body_index(scene, joint.parent);
  r.child = body_index(scene, joint.child);
  return r;
}
static_assert(static_cast<int>(JointKind::kUniversal) == static_cast<int>(exchange::JointType::kUniversal) &&
              static_cast<int>(JointKind::kBall) == static_cast<int>(exchange::JointType::kBall) &&
              static_cast<int>(JointKind::kPrismatic) == static_cast<int>(exchange::JointType::kPrismatic) &&
              static_cast<int>(JointKind::kRevolute) == static_cast<int>(exchange::JointType::kRevolute));

// Median over the free bodies (over all solid ones if none is free) of the edge of a cube, or square, of their volume.
double length_scale(const Scene& scene, const std::vector<Body>& bodies) {
  std::vector<double> sizes, free;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double volume = bodies[i].solid.mass_properties().volume;
    if (!(volume > 0)) continue;
    sizes.push_back(scene.world.dimension == 2 ? std::sqrt(volume) : std::cbrt(volume));
    if (scene.models[i].motion == Motion::kDynamic) free.push_back(sizes.back());
  }
  std::vector<double>& chosen = free.empty() ? sizes : free;
  if (chosen.empty()) return 1;
  const auto middle = chosen.begin() + static_cast<std::ptrdiff_t>(chosen.size() / 2);
  std::nth_element(chosen.begin(), middle, chosen.end());
  return *middle;
}

}  // namespace

Manifest make_manifest(const Scene& scene, const std::vector<Body>& bodies) {
  Manifest manifest;
  exchange::WorldRecord& world = manifest.world;
  copy(scene.world.gravity, world.gravity);
  world.duration = scene.world.duration;
  world.rigid_step = scene.coupling.rigid_step;
  world.length_scale = length_scale(scene, bodies);
  world.dimension = static_cast<std::uint32_t>(scene.world.dimension);
  world.substeps = static_cast<std::uint32_t>(std::max(1, scene.coupling.substeps));
  world.seed = scene.world.seed;
  world.output_every = scene.output.every;
  world.sleep_speed = scene.world.sleep_speed;
  world.sleep_after = scene.world.sleep_after;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    BodyRecord record = body_record(scene.models[i], bodies[i]);
    record.first_shape = static_cast<std::uint32_t>(manifest.shapes.size());
    for (const SolidPiece& piece : bodies[i].solid.pieces()) add_shape(piece, static_cast<std::uint32_t>(i), manifest);
    record.shape_count = static_cast<std::uint32_t>(manifest.shapes.size()) - record.first_shape;
    manifest.bodies.push_back(record);
  }
  for (const Joint& joint : scene.joints) manifest.joints.push_back(joint_record(scene, joint));
  return manifest;
}

}  // namespace ballast
