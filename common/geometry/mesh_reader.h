// Triangles out of a mesh file, by assimp in a process of its own: whatever a damaged file does to it, the caller gets
// an error.
#pragma once
#include <string>

#include "common/geometry/solid.h"
#include "common/result.h"

namespace ballast::geometry {

/// Every triangle of OBJ, STL, PLY and whatever else assimp knows, vertices as in the file (m).
/// The reader may use 20 s of processor time and 1 s per MB, and 512 MB of memory and 300 bytes per byte of the file.
Result<TriangleMesh> read_triangles(const std::string& file);

}  // namespace ballast::geometry
