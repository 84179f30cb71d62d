// The manifest: what a rigid engine must know about the bodies of a run, as plain records.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/exchange/records.h"

namespace ballast::exchange {

/// Read-only view into shared memory (or into a Manifest).
struct ManifestView {
  const WorldRecord* world = nullptr;
  std::span<const BodyRecord> bodies;
  std::span<const ShapeRecord> shapes;
  std::span<const JointRecord> joints;
  std::span<const double> vertices;          ///< x y z ..., m, frame of the shape
  std::span<const std::uint32_t> triangles;  ///< three vertex indices each, relative to the shape's first_vertex
};

/// The same, owning its data.
struct Manifest {
  WorldRecord world{};
  std::vector<BodyRecord> bodies;
  std::vector<ShapeRecord> shapes;
  std::vector<JointRecord> joints;
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles;
  ManifestView view() const { return {&world, bodies, shapes, joints, vertices, triangles}; }
};

}  // namespace ballast::exchange
