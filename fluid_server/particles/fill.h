// The start: particles on a lattice where the fluid is, bodies carved out, exact volume, hydrostatic pressure.
#pragma once
#include <string>
#include <vector>

#include "common/geometry/bodies.h"
#include "common/result.h"
#include "fluid_server/particles/coordinates.h"
#include "fluid_server/particles/particles.h"

namespace ballast::fluid {

/// What came of one fluid's fill; goes into the run record.
struct FillReport {
  std::string fluid;
  double volume_asked = 0;  ///< m^3, of the fill without bodies
  double volume_got = 0;    ///< m^3, after carving: particles times their volume
  double mass_asked = 0;    ///< kg
  double mass = 0;          ///< kg, got
  double top = 0;           ///< m, height of the surface: where the starting pressure is zero
  std::size_t particles = 0;
};

struct Filled {
  Particles particles;  ///< in order of id, not yet sorted
  std::vector<FluidProperties> fluids;
  std::vector<Record> ghosts;  ///< lattice sites just outside the fills: hold the surface while relaxing
  std::vector<FillReport> reports;
};

/// Fills every fluid of the scene; every particle of one fluid has the same volume, so that their sum is the exact
/// volume. Errors: exit code 2 (empty fill, fill outside the domain, unknown container).
Result<Filled> fill_fluids(const Scene& scene, const std::vector<Body>& bodies, const Coordinates& coordinates,
                           double support);

}  // namespace ballast::fluid
