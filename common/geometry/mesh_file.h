// Mesh files to checked triangle meshes.
#pragma once
#include <string>

#include "common/geometry/solid.h"
#include "common/result.h"

namespace ballast::geometry {

/// Reads OBJ, STL, PLY and whatever else assimp knows, scales it per axis, and welds equal vertices.
/// Refuses files without triangles and numbers that are not finite.
Result<TriangleMesh> read_mesh(const std::string& file, const Vec3& scale);

/// Welds vertices that are bitwise equal, drops triangles with two equal corners and vertices without triangles.
TriangleMesh weld(const TriangleMesh& mesh);

/// Refuses surfaces that are open, where triangles meet with opposite sense, or that are inside out.
Status check_closed(const TriangleMesh& mesh);

/// Volume, centre and inertia by the divergence theorem (exact for the polyhedron).
MassProperties mesh_mass(const TriangleMesh& mesh);

}  // namespace ballast::geometry
