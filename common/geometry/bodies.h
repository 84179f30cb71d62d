// From the scene's models to solids, masses and the manifest; the order of scene.models is the body index everywhere.
#pragma once
#include <vector>

#include "common/exchange/manifest.h"
#include "common/geometry/solid.h"
#include "common/result.h"
#include "common/scene/scene.h"

namespace ballast {

/// One model made concrete.
struct Body {
  Solid solid;
  Pose pose;                                          ///< of the body frame at t = 0
  double mass = 0;                                    ///< kg (per metre of depth in dimension 2); 0 unless dynamic
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  ///< about the centre of mass, body axes, kg m^2
};

/// Makes all bodies; refuses meshes that cannot be read (place of the model, cure), dynamic planes and containers
/// without mass, and bodies that overlap by more than 1e-4 of the smaller one's size at t = 0 (names and depth) unless
/// scene.world.allow_overlap. Static-static pairs may overlap; bodies joined by a joint may overlap. Errors: exit
/// code 2.
Result<std::vector<Body>> make_bodies(const Scene& scene);

/// Records for the rigid side. Containers become their walls (boxes; a hollow sphere or cylinder becomes a mesh),
/// compounds their parts, planes stay planes. In dimension 2 shapes extend over the depth of 1 m about y = 0
/// (a sphere becomes a cylinder along y).
exchange::Manifest make_manifest(const Scene& scene, const std::vector<Body>& bodies);

}  // namespace ballast
