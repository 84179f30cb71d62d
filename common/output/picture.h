// picture.png of a state: a POV-Ray scene file and its rendering, which needs no display.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/geometry/bodies.h"
#include "common/output/particles.h"
#include "common/result.h"

namespace ballast::output {

/// Writes the POV-Ray scene `path`: particles as spheres coloured by speed (deep blue at rest, white at the fastest),
/// moving bodies in warm colours, containers as edges and floor, other static bodies grey. `poses`: one per body, body
/// frames. Dimension 2 is seen from the front (along +y, orthographic). Camera: scene.output.camera, or chosen.
Status write_pov(const std::string& path, const Scene& scene, const std::vector<Body>& bodies,
                 std::span<const Pose> poses, const ParticleFrame& particles);

/// write_pov to `folder`/picture.pov, then `folder`/picture.png, 1280 x 720, by the program povray. An error is a
/// warning to print, never a reason to end a run: it says that povray is missing and how to install it, or how it
/// failed.
Status make_picture(const std::string& folder, const Scene& scene, const std::vector<Body>& bodies,
                    std::span<const Pose> poses, const ParticleFrame& particles, int threads);

}  // namespace ballast::output
