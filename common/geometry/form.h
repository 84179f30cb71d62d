// What every kind of solid can do in the frame of its own model; Solid wraps one Form and moves it to the body frame.
// In dimension 2 callers pass points with y = 0, and forms must not let their extent along y matter.
#pragma once
#include <limits>
#include <memory>
#include <vector>

#include "common/geometry/solid.h"

namespace ballast::geometry {

inline constexpr double kInf = std::numeric_limits<double>::infinity();

/// What samples() is asked for, see Solid::samples; window in the model's frame.
struct SampleRequest {
  double spacing = 0;
  double depth = 0;
  Box3 window;
};

class Form {
 public:
  virtual ~Form() = default;
  virtual MassProperties mass_properties() const = 0;
  virtual double distance(const Vec3& p) const = 0;
  /// Unit gradient of distance. The default takes central differences, exact to about 1e-9 for the shapes that use it.
  virtual Vec3 normal(const Vec3& p) const;
  virtual Box3 bounds() const = 0;
  virtual bool is_container() const { return false; }
  virtual double room_distance(const Vec3&) const { return kInf; }
  /// Positions and volumes only; Solid adds depth and normal. May reach beyond the window: Solid cuts.
  virtual std::vector<SurfaceSample> samples(const SampleRequest& request) const = 0;
  virtual TriangleMesh surface() const = 0;
  /// See Solid::pieces, here in the model's frame. The default is the surface as one mesh.
  virtual std::vector<SolidPiece> pieces() const;
};

using FormPtr = std::unique_ptr<const Form>;

/// Any shape; spacing gives default walls. Errors have no place (Solid does not know it).
Result<FormPtr> make_form(const Shape& shape, int dimension, double spacing);

FormPtr make_box(const Vec3& size, int dimension);
FormPtr make_open_box(const Vec3& inside, double wall, bool lid, int dimension);
FormPtr make_plane(const Vec3& normal, int dimension);
/// Sphere, or disc in dimension 2; wall > 0 makes it a room of that radius.
FormPtr make_ball(double radius, double wall, int dimension);
/// Dimension 3, axis z; wall > 0 makes it a closed room of that radius and length.
FormPtr make_cylinder(double radius, double length, double wall);
/// Dimension 3, axis z, `length` between the cap centres.
FormPtr make_capsule(double radius, double length);
/// Closed outward mesh; in dimension 2 its section at y = 0.
Result<FormPtr> make_mesh(TriangleMesh mesh, int dimension);
Result<FormPtr> make_compound(const std::vector<Part>& parts, int dimension, double spacing);

/// Wall thickness of a container: as given, else three spacings, else (no spacing) a twentieth of its size.
double wall_thickness(const Shape& shape, double spacing);
/// The walls of an open box as boxes that touch but do not overlap; y from -0.5 to 0.5 in dimension 2.
std::vector<Box3> open_box_walls(const Vec3& inside, double wall, bool lid, int dimension);

/// Signed distance to an axis-aligned box that may be infinite in some directions.
double box_distance(const Vec3& p, const Vec3& lo, const Vec3& hi);

/// The rotation that turns the z axis into the y axis: cylinders of dimension 2.
inline Quat z_to_y() { return Quat(Eigen::AngleAxisd(-1.5707963267948966, Vec3::UnitX())); }

inline bool contains(const Box3& box, const Vec3& p, int dimension) {
  for (int a = 0; a < 3; ++a) {
    if (dimension == 2 && a == 1) continue;
    if (p[a] < box.min[a] || p[a] > box.max[a]) return false;
  }
  return true;
}

}  // namespace ballast::geometry
