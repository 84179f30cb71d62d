// ParaView files in VTK's XML PolyData format, arrays appended raw behind the XML (VTK file formats, "XML File
// Formats").
#include "common/output/vtk.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "common/output/whole_file.h"

namespace ballast::output {
namespace {

template <class T>
constexpr const char* vtk_type() {
  if constexpr (std::is_same_v<T, float>) return "Float32";
  if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
  return "Int32";
}

/// Collects the XML part and the raw block that its arrays point into.
class PolyData {
 public:
  PolyData(std::size_t points, std::size_t verts, std::size_t polys) {
    xml_ = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" "
        "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
        points, verts, polys);
  }
  void open(std::string_view tag) { xml_ += fmt::format("<{}>\n", tag); }
  void close(std::string_view tag) { xml_ += fmt::format("</{}>\n", tag); }

  template <class T>
  void array(std::string_view name, int components, std::span<const T> values) {
    xml_ += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        vtk_type<T>(), name, components, raw_.size());
    const std::uint64_t bytes = values.size_bytes();
    raw_.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    raw_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }

  Status write(const std::string& path) {
    xml_ += "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
    xml_ += raw_;
    xml_ += "\n</AppendedData>\n</VTKFile>\n";
    return write_whole(path, xml_);
  }

 private:
  std::string xml_, raw_;
};

std::string pvd(std::string_view prefix, const std::vector<double>& times) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (std::size_t i = 0; i < times.size(); ++i) {
    text += fmt::format("<DataSet timestep=\"{:.9g}\" part=\"0\" file=\"{}_{:05}.vtp\"/>\n", times[i], prefix, i);
  }
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace

Status write_particles_vtp(const std::string& path, const ParticleFrame& particles) {
  const std::size_t count = particles.position.size() / 3;
  std::vector<std::int64_t> connectivity(count), offsets(count);
  for (std::size_t i = 0; i < count; ++i) {
    connectivity[i] = static_cast<std::int64_t>(i);
    offsets[i] = static_cast<std::int64_t>(i) + 1;
  }
  PolyData file(count, count, 0);
  file.open("PointData");
  if (!particles.velocity.empty()) file.array("velocity", 3, particles.velocity);
  if (!particles.pressure.empty()) file.array("pressure", 1, particles.pressure);
  if (!particles.density.empty()) file.array("density", 1, particles.density);
  file.close("PointData");
  file.open("Points");
  file.array("Points", 3, particles.position);
  file.close("Points");
  file.open("Verts");
  file.array("connectivity", 1, std::span<const std::int64_t>(connectivity));
  file.array("offsets", 1, std::span<const std::int64_t>(offsets));
  file.close("Verts");
  return file.write(path);
}

Status write_bodies_vtp(const std::string& path, const std::vector<Body>& bodies, std::span<const Pose> poses) {
  std::vector<float> points;
  std::vector<std::int64_t> connectivity, offsets;
  std::vector<std::int32_t> body_of_cell;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const TriangleMesh mesh = bodies[b].solid.surface();
    const auto first = static_cast<std::int64_t>(points.size() / 3);
    for (const Vec3& v : mesh.vertices) {
      const Vec3 world = poses[b].position + poses[b].rotation * v;
      for (int k = 0; k < 3; ++k) points.push_back(static_cast<float>(world[k]));
    }
    for (const auto& triangle : mesh.triangles) {
      for (std::uint32_t v : triangle) connectivity.push_back(first + v);
      offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
      body_of_cell.push_back(static_cast<std::int32_t>(b));
    }
  }
  PolyData file(points.size() / 3, 0, offsets.size());
  file.open("CellData");
  file.array("body", 1, std::span<const std::int32_t>(body_of_cell));
  file.close("CellData");
  file.open("Points");
  file.array("Points", 3, std::span<const float>(points));
  file.close("Points");
  file.open("Polys");
  file.array("connectivity", 1, std::span<const std::int64_t>(connectivity));
  file.array("offsets", 1, std::span<const std::int64_t>(offsets));
  file.close("Polys");
  return file.write(path);
}

VtkSeries::VtkSeries(std::string folder) : folder_(std::move(folder)) {}

Status VtkSeries::add(double time, const ParticleFrame& particles, const std::vector<Body>& bodies,
                      std::span<const Pose> poses) {
  std::error_code failed;
  std::filesystem::create_directories(folder_, failed);
  if (failed) return Error{"cannot make folder " + folder_ + ": " + failed.message(), "choose another --out", ""};
  const std::size_t index = times_.size();
  times_.push_back(time);
  any_particles_ = any_particles_ || !particles.position.empty();
  if (any_particles_) {
    if (Status s = write_particles_vtp(fmt::format("{}/particles_{:05}.vtp", folder_, index), particles); !s) return s;
    if (Status s = write_whole(folder_ + "/particles.pvd", pvd("particles", times_)); !s) return s;
  }
  if (bodies.empty()) return ok();
  if (Status s = write_bodies_vtp(fmt::format("{}/bodies_{:05}.vtp", folder_, index), bodies, poses); !s) return s;
  return write_whole(folder_ + "/bodies.pvd", pvd("bodies", times_));
}

}  // namespace ballast::output
