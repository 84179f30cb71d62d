// Triangle surfaces of the simple shapes, for drawing, for engines that take meshes and for finding overlaps.
#pragma once
#include <array>
#include <vector>

#include "common/geometry/solid.h"

namespace ballast::geometry {

TriangleMesh box_mesh(const Box3& box);
/// Profile points (radius, z) revolved about z, in order from the top to the bottom axis point; a closed profile is a
/// loop around a hole, counter-clockwise seen with the radius to the right and z up.
TriangleMesh revolved(const std::vector<std::array<double, 2>>& profile, bool closed);
/// Half circle from +90 to -90 degrees, the profile of a sphere, shifted outwards along z by half_length (capsule).
std::vector<std::array<double, 2>> round_profile(double radius, double half_length);
/// Adds a mesh; inside_out turns its triangles around.
void append(TriangleMesh& mesh, const TriangleMesh& other, bool inside_out = false);
/// Turns the z axis into the y axis: cylinders of dimension 2.
void turn_z_to_y(TriangleMesh& mesh);

}  // namespace ballast::geometry
