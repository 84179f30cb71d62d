// A solid of the scene, ready for computing: signed distance, mass properties, surface samples, overlap.
// All functions work in the *body frame*: origin at the centre of mass, axes parallel to the model's frame. For static
// and prescribed bodies the body frame is the model's frame.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/result.h"
#include "common/scene/scene.h"

namespace ballast {

/// Mass properties of a uniform solid. In dimension 2: of its section at y = 0 times 1 m of depth.
struct MassProperties {
  double volume = 0;                                  ///< m^3
  Vec3 centre = Vec3::Zero();                         ///< centre of mass in the model's frame, m
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre, model axes, for unit density, m^5
};

/// Closed triangle surface, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> vertices;  ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Dummy particle inside a solid near its surface (WALLS: layers at depth d/2, 3d/2, ... each with its exact share of
/// volume).
struct SurfaceSample {
  Vec3 position = Vec3::Zero();  ///< body frame, m
  Vec3 normal = Vec3::Zero();    ///< unit, out of the solid, at the nearest surface point
  double depth = 0;              ///< distance below the surface, m, > 0
  double volume = 0;             ///< share of the solid's volume, m^3 (m^2 * 1 m in dimension 2)
};

/// One simple part of a solid as rigid engines know them: box, sphere, cylinder, capsule (axis z), plane or mesh.
struct SolidPiece {
  ShapeKind kind = ShapeKind::kBox;
  Pose pose;                   ///< in the body frame
  Vec3 size = Vec3::Zero();    ///< kBox: full edges, m
  double radius = 0;           ///< m
  double length = 0;           ///< kCylinder: whole length; kCapsule: between the cap centres, m
  Vec3 normal = Vec3::Zero();  ///< kPlane: frame of the pose, solid on the other side
  TriangleMesh mesh;           ///< kMesh: frame of the pose
};

/// A solid: one shape or a compound, with everything precomputed. Immutable; safe to share between threads.
class Solid {
 public:
  /// Reads the mesh file if there is one (assimp: OBJ, STL, PLY, ...); refuses an open, empty or inside-out surface,
  /// zero sizes. `spacing` gives the default wall thickness of containers (three spacings). Errors: exit code 2.
  static Result<Solid> make(const Shape& shape, int dimension, double spacing, bool centre_on_mass);
  Solid(Solid&&) noexcept;
  Solid& operator=(Solid&&) noexcept;
  ~Solid();

  const MassProperties& mass_properties() const;  ///< infinite solids (plane): volume 0

  /// Signed distance to the surface in the body frame, m: negative inside the solid. In dimension 2, y is ignored.
  double distance(const Vec3& point) const;
  /// Unit gradient of distance (out of the solid).
  Vec3 normal(const Vec3& point) const;

  /// Bounds in the body frame, m; infinite for a plane.
  Box3 bounds() const;

  /// True for open boxes and hollow shapes: they have an inside that can hold fluid and bodies.
  bool is_container() const;
  /// Signed distance to the boundary of the room inside a container: negative inside the room (an open top counts as
  /// unbounded above).
  double room_distance(const Vec3& point) const;

  /// Samples filling the solid from its surface inwards to `depth` (at least; layers of about `spacing`).
  /// Only those within `window` (body frame) are made: planes are infinite. Volume shares add up to the volume of the
  /// layer that they fill (to rounding for boxes, spheres, cylinders; 0.5 % for meshes and compounds).
  std::vector<SurfaceSample> samples(double spacing, double depth, const Box3& window) const;

  /// Triangles of the surface for drawing and for engines that take meshes (body frame); planes give an empty mesh.
  TriangleMesh surface() const;

  /// The parts that make up the solid, for rigid engines: walls of open boxes, meshes of hollow shapes, parts of
  /// compounds. In dimension 2 they extend from y = -0.5 to 0.5.
  std::vector<SolidPiece> pieces() const;

  int dimension() const;

 private:
  struct Data;
  explicit Solid(std::unique_ptr<const Data> data);
  std::unique_ptr<const Data> data_;
};

/// How deep two posed solids overlap, m (0 if they do not): largest distance by which a point of one lies inside the
/// other, found on surface points at least as fine as `resolution`. Touching to within 1e-6 of their size counts as 0.
double overlap_depth(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b, double resolution);

/// Body-frame pose of a model: frame of the scene file moved to the centre of mass.
Pose body_pose(const Pose& model_pose, const Solid& solid, Motion motion);

}  // namespace ballast
