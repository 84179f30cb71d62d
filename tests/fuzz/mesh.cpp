// Any file is a closed mesh with finite mass properties or an error with words. The first byte chooses the format.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "common/geometry/mesh_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  const char* endings[] = {".obj", ".stl", ".ply"};
  const std::string file = "/dev/shm/ballast_fuzz_" + std::to_string(getpid()) + endings[data[0] % 3];
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data + 1), static_cast<long>(size - 1));
  const auto mesh = ballast::geometry::read_mesh(file, ballast::Vec3::Ones());
  unlink(file.c_str());
  if (!mesh) {
    if (mesh.error().what.empty() || mesh.error().cure.empty()) std::abort();
    return 0;
  }
  for (const auto& triangle : mesh->triangles)
    for (const auto corner : triangle)
      if (corner >= mesh->vertices.size()) std::abort();
  if (!ballast::geometry::check_closed(*mesh)) return 0;
  if (std::isnan(ballast::geometry::mesh_mass(*mesh).volume)) std::abort();
  return 0;
}
