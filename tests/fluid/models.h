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

/// Taylor-Green vortices of 1 m/s in a periodic square of 1 m, 32 particles along it; viscosity in Pa s.
inline Scene vortices(float viscosity) {
  Scene scene;
  scene.world.dimension = 2;
  scene.world.spacing = 1.0 / 32;
  scene.world.gravity = Vec3::Zero();
  scene.world.periodic = {true, false, true};
  scene.world.domain = Box3{{0, -1, 0}, {1, 1, 1}};
  scene.numerics.artificial_viscosity = 0;
  Fluid water;
  water.viscosity = viscosity;
  water.vortex_speed = 1;
  water.fill.box = {{0, -0.5, 0}, {1, 0.5, 1}};
  scene.fluids.push_back(water);
  return scene;
}

}  // namespace ballast::fluid
