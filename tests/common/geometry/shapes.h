// Short ways to write down shapes, solids and meshes in the tests of this folder.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "common/geometry/solid.h"

namespace ballast::test {

inline constexpr double kPi = std::numbers::pi;
inline const Box3 kEverywhere{Vec3::Constant(-1e3), Vec3::Constant(1e3)};

inline Shape box(const Vec3& size) {
  Shape s;
  s.size = size;
  return s;
}
inline Shape open_box(const Vec3& inside, double wall = 0, bool lid = false) {
  Shape s;
  s.kind = ShapeKind::kOpenBox;
  s.size = inside;
  s.wall = wall;
  s.lid = lid;
  return s;
}
inline Shape round_shape(ShapeKind kind, double radius, double length = 0, double wall = 0) {
  Shape s;
  s.kind = kind;
  s.radius = radius;
  s.length = length;
  s.wall = wall;
  s.hollow = wall > 0;
  return s;
}
inline Shape sphere(double r, double wall = 0) { return round_shape(ShapeKind::kSphere, r, 0, wall); }
inline Shape cylinder(double r, double l, double wall = 0) { return round_shape(ShapeKind::kCylinder, r, l, wall); }
inline Shape capsule(double r, double l) { return round_shape(ShapeKind::kCapsule, r, l); }
inline Shape plane(const Vec3& normal) {
  Shape s;
  s.kind = ShapeKind::kPlane;
  s.normal = normal;
  return s;
}
inline Shape mesh(const std::string& file, const Vec3& scale = Vec3::Ones()) {
  Shape s;
  s.kind = ShapeKind::kMesh;
  s.mesh = file;
  s.scale = scale;
  return s;
}
inline Shape compound(std::vector<Part> parts) {
  Shape s;
  s.kind = ShapeKind::kCompound;
  s.parts = std::move(parts);
  return s;
}

inline Solid solid(const Shape& shape, int dimension = 3, double spacing = 0.01, bool centre_on_mass = false) {
  Result<Solid> made = Solid::make(shape, dimension, spacing, centre_on_mass);
  if (!made) throw std::runtime_error(made.error().text());
  return std::move(*made);
}

inline double total_volume(const std::vector<SurfaceSample>& samples) {
  double sum = 0;
  for (const SurfaceSample& s : samples) sum += s.volume;
  return sum;
}

/// A file in the temporary folder that is gone when the object is.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& ending, const std::string& text) {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() / (std::string("ballast_") + info->test_suite_name() + "_" +
                                                      info->name() + std::to_string(getpid()) + ending);
    std::ofstream(path_) << text;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// A cuboid 2 x 3 x 4 with a corner at (1, 1, -2) as OBJ text, with faces of four corners.
inline const char* const kCuboidObj =
    "v 1 1 -2\nv 3 1 -2\nv 3 4 -2\nv 1 4 -2\nv 1 1 2\nv 3 1 2\nv 3 4 2\nv 1 4 2\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// OBJ text of a mesh.
inline std::string obj_text(const TriangleMesh& m) {
  std::string text;
  char line[128];
  for (const Vec3& v : m.vertices) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", v.x(), v.y(), v.z());
    text += line;
  }
  for (const auto& t : m.triangles) {
    std::snprintf(line, sizeof line, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
    text += line;
  }
  return text;
}

}  // namespace ballast::test
