// Samples of any solid that only knows its signed distance: meshes and compounds of overlapping parts.
#pragma once
#include <functional>

#include "common/geometry/form.h"

namespace ballast::geometry {

/// Share of a cubic cell (centre, edge) that is solid; leave empty to estimate it from the distance.
using CellShare = std::function<double(const Vec3& centre, double edge)>;

/// Points on layers at depth d/2, 3d/2, ... about d apart; each stands for the part of a fine grid (d/4) nearest to it.
/// Deterministic. A solid filled to its middle gets its exact volume.
std::vector<SurfaceSample> general_samples(const Form& form, int dimension, const SampleRequest& request,
                                           const CellShare& share = {});

}  // namespace ballast::geometry
