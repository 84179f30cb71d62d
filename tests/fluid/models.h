// Models that several tests of the fluid put together scenes from.
#pragma once
#include <string>

#include "common/scene/scene.h"

namespace ballast::fluid {

/// A static open box with these inside lengths, m; its inside begins at `corner`.
inline Model tank(const Vec3& inside, const Vec3& corner = Vec3::Zero()) {
  Model m;
  m.name = "tank";
  m.motion = Motion::kStatic;
  m.shape.kind = ShapeKind::kOpenBox;
  m.shape.size = inside;
  m.pose.position = corner;
  return m;
}

/// A free box.
inline Model box_body(const std::string& name, const Vec3& size, double density, const Vec3& position) {
  Model m;
  m.name = name;
  m.shape.kind = ShapeKind::kBox;
  m.shape.size = size;
  m.density = density;
  m.pose.position = position;
  return m;
}

}  // namespace ballast::fluid
