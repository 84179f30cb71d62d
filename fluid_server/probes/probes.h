// What the scene's probes read from the fluid and the bodies; columns as in common/output/columns.h.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "common/exchange/records.h"
#include "common/scene/scene.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

/// Values of all probes now, in the order of scene.probes.
std::vector<double> read_probes(const Scene& scene, const WcsphFluid& fluid,
                                std::span<const exchange::BodyState> states);

/// Height of the free surface above (x, y): highest z where the kernel sum of the particles crosses one half, m; the
/// lowest z of the domain if there is no fluid.
double surface_level(const WcsphFluid& fluid, double x, double y);

/// Kernel mean of the particles' pressure, carried to the point along the hydrostatic gradient, Pa; 0 away from fluid.
double pressure_at(const WcsphFluid& fluid, const Vec3& point);

/// Value at the point of the quadratic field that fits the particles' velocities best, weighted by the kernel, m/s:
/// exact for quadratic fields, where a mean or a linear one would take the top off a profile. Where particles are on
/// one side only, of the linear one: exact for linear fields also beside walls. 0 away from fluid.
Vec3 velocity_at(const WcsphFluid& fluid, const Vec3& point);

/// Momentum, angular momentum about the origin and largest speed of the fluid `which` of the scene; SI units.
std::array<double, 7> motion_of(const WcsphFluid& fluid, std::size_t which);

/// Volume of the largest void in the fluid `which` of the scene: places that it encloses, further than a spacing from
/// all of its particles, m^3 (in dimension 2 of 1 m of depth). In a lattice no place is; where particles are in
/// disorder some are, for a moment and for less than a particle's volume. What is open to the outside or to a wall
/// around the fluid is no void; a body that the fluid encloses counts as one. On a grid of half a spacing.
/// Not a number where strays lie so far apart that it would have more than 1e8 places.
double largest_void(const WcsphFluid& fluid, std::size_t which);

/// Particles whose centre a body would hold at a pose.
std::size_t count_inside(const Body& body, const Pose& pose, const WcsphFluid& fluid);

/// Particles that are more than half a spacing inside a solid or outside every container that the scene has.
std::size_t count_misplaced(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid,
                            std::span<const exchange::BodyState> states);

}  // namespace ballast::fluid
