// Probes that could only ever see nothing.
#include <fmt/format.h>

#include <cmath>

#include "launch/prepare.h"

namespace ballast::launch {

namespace {

constexpr double kMargin =
    9;  // spacings beyond everything in the scene where particles still are: the fluid's own domain
constexpr double kDeep = 2;  // spacings inside a solid from where a kernel reaches no particle

void extend(Box3& box, const Vec3& x) {
  box.min = box.min.cwiseMin(x);
  box.max = box.max.cwiseMax(x);
}

/// Where particles may be, about: world.domain, or around everything in the scene and as high as splashes may rise.
Box3 reach_of(const Scene& scene, const std::vector<Body>& bodies) {
  if (scene.world.domain) return *scene.world.domain;
  Box3 box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const Fluid& fluid : scene.fluids) {
    if (fluid.fill.kind == FillKind::kBox) extend(box, fluid.fill.box.min), extend(box, fluid.fill.box.max);
    if (fluid.fill.kind == FillKind::kMesh) extend(box, fluid.fill.pose.position);
  }
  for (const Body& body : bodies) {
    const Box3 local = body.solid.bounds();
    if (!(local.min.norm() < 1e100) || !(local.max.norm() < 1e100)) continue;  // a plane
    for (int c = 0; c < 8; ++c)
      extend(box, body.pose.position + body.pose.rotation * Vec3((c & 1 ? local.max : local.min).x(),
                                                                 (c & 2 ? local.max : local.min).y(),
                                                                 (c & 4 ? local.max : local.min).z()));
  }
  const double margin = kMargin * scene.world.spacing, height = box.max.z() - box.min.z();
  box.min.array() -= margin;
  box.max.array() += margin;
  box.max.z() += 1.5 * height;
  return box;
}

/// The solid that stays where it is and has this point deep inside; nullptr: none.
const Model* solid_at(const Scene& scene, const std::vector<Body>& bodies, const Vec3& x) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (scene.models[b].motion != Motion::kStatic) continue;
    const Solid& solid = bodies[b].solid;
    const Vec3 local = bodies[b].pose.rotation.conjugate() * (x - bodies[b].pose.position);
    const double deep = kDeep * scene.world.spacing, inside = -solid.distance(local);
    if (solid.is_container() ? inside > 0 && solid.room_distance(local) > deep : inside > deep) return &scene.models[b];
  }
  return nullptr;
}

Error refused(const Probe& probe, const std::string& what, const std::string& cure) {
  return {fmt::format("the probe '{}' {}", probe.name, what), cure,
          fmt::format("{}:{}:{}", probe.place.file, probe.place.line, probe.place.column)};
}

Status check(const Scene& scene, const std::vector<Body>& bodies, const Box3& reach, const Probe& probe) {
  const bool level = probe.kind == ProbeKind::kLevel, flat = scene.world.dimension == 2;
  for (int k = 0; k < (level ? 2 : 3); ++k) {
    if (flat && k == 1) continue;
    if (probe.at[k] >= reach.min[k] && probe.at[k] <= reach.max[k]) continue;
    return refused(
        probe,
        fmt::format("is at {} = {:g} m, where no fluid can be: {} goes from {:.3g} to {:.3g} m", "xyz"[k], probe.at[k],
                    scene.world.domain ? "world.domain" : "the domain around the scene", reach.min[k], reach.max[k]),
        "move it to where fluid is, or enlarge world.domain");
  }
  Vec3 at = probe.at;
  if (flat) at.y() = 0;
  if (const Model* solid = level ? nullptr : solid_at(scene, bodies, at))
    return refused(probe, fmt::format("is deep inside the static model '{}', where no fluid can be", solid->name),
                   "move it to where fluid is");
  return ok();
}

}  // namespace

Status check_probes(const Scene& scene, const std::vector<Body>& bodies) {
  if (scene.fluids.empty()) return ok();
  const Box3 reach = reach_of(scene, bodies);
  for (Probe probe : scene.probes) {
    for (std::size_t b = 0; b < bodies.size(); ++b)  // where it is at the start
      if (!probe.frame.empty() && scene.models[b].name == probe.frame)
        probe.at = bodies[b].pose.position + bodies[b].pose.rotation * probe.at;
    if (probe.kind != ProbeKind::kLevel && probe.kind != ProbeKind::kPressure) continue;
    if (Status s = check(scene, bodies, reach, probe); !s) return s;
  }
  return ok();
}

}  // namespace ballast::launch
