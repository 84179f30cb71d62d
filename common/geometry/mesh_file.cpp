// Mesh files to checked triangle meshes.
#include "common/geometry/mesh_file.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/IOStream.hpp>
#include <assimp/Importer.hpp>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

namespace ballast::geometry {

namespace {

/// Passes on, and loses patience where assimp goes round in circles in a damaged file (its PLY reader does).
class PatientStream : public Assimp::IOStream {
 public:
  explicit PatientStream(Assimp::IOStream* inner) : inner_(inner), left_(10'000 + 4 * inner->FileSize()) {}
  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    return wait(), inner_->Read(to, size, count);
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override { return wait(), inner_->Seek(offset, origin); }
  std::size_t Tell() const override { return inner_->Tell(); }
  std::size_t FileSize() const override { return inner_->FileSize(); }
  void Flush() override {}

 private:
  void wait() {
    // assimp turns the exception into its error text; each byte could have been read four times over
    if (left_-- == 0) throw std::runtime_error("the file is damaged: reading it does not come to an end");
  }
  std::unique_ptr<Assimp::IOStream> inner_;
  std::size_t left_;
};

class PatientFiles : public Assimp::DefaultIOSystem {
 public:
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    Assimp::IOStream* inner = DefaultIOSystem::Open(file, mode);
    return inner ? new PatientStream(inner) : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }
};

}  // namespace

Result<TriangleMesh> read_mesh(const std::string& file, const Vec3& scale) {
  if (!scale.allFinite() || scale.cwiseAbs().minCoeff() <= 0) {
    return Error{fmt::format("scale of mesh '{}' is ({}, {}, {})", file, scale.x(), scale.y(), scale.z()),
                 "give finite factors other than 0", "", kBadInput};
  }
  Assimp::Importer importer;
  importer.SetIOHandler(new PatientFiles);  // the importer owns it
  // Only positions matter: other attributes would split vertices along seams and open the surface.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(file, aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (!scene || scene->mNumMeshes == 0) {
    const std::string reason = importer.GetErrorString();
    return Error{fmt::format("cannot read mesh '{}': {}", file, reason.empty() ? "no triangles in it" : reason),
                 "check the path and that the file is OBJ, STL or PLY with a closed surface", "", kBadInput};
  }
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      mesh.vertices.push_back(Vec3(p.x, p.y, p.z).cwiseProduct(scale));
      if (!mesh.vertices.back().allFinite()) {
        return Error{fmt::format("vertex {} of mesh '{}' is not finite", v, file), "repair the mesh", "", kBadInput};
      }
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;
      mesh.triangles.push_back({base + face.mIndices[0], base + face.mIndices[1], base + face.mIndices[2]});
      if (scale.prod() < 0) std::swap(mesh.triangles.back()[1], mesh.triangles.back()[2]);  // mirrored
    }
  }
  mesh = weld(mesh);
  const auto name_file = [&](Error error) {
    return error.what = fmt::format("mesh '{}': {}", file, error.what), error;
  };
  if (const Status closed = check_closed(mesh); !closed) return name_file(closed.error());
  return mesh;
}

TriangleMesh weld(const TriangleMesh& mesh) {
  TriangleMesh out;
  std::map<std::array<double, 3>, std::uint32_t> seen;
  const auto index = [&](std::uint32_t v) {
    const Vec3& p = mesh.vertices[v];
    // + 0.0 turns -0 into 0.
    const auto [it, fresh] = seen.try_emplace({p.x() + 0.0, p.y() + 0.0, p.z() + 0.0}, out.vertices.size());
    if (fresh) out.vertices.push_back(p);
    return it->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::array<std::uint32_t, 3> t{index(a), index(b), index(c)};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) out.triangles.push_back(t);
  }
  return out;
}

Status check_closed(const TriangleMesh& mesh) {
  const auto refuse = [](std::string what, std::string cure) -> Status {
    return Error{std::move(what), std::move(cure), "", kBadInput};
  };
  if (mesh.triangles.empty()) return refuse("no triangles in it", "give a closed surface with an inside");
  // Every directed edge needs exactly as many opposite ones.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      balance[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  std::size_t open = 0;
  const Vec3* at = nullptr;
  for (const auto& [edge, sum] : balance) {
    if (sum == 0) continue;
    ++open;
    if (!at) at = &mesh.vertices[edge.first];
  }
  if (open > 0) {
    return refuse(
        fmt::format("the surface is open: {} of {} edges lack a partner, the first near ({:.6g}, {:.6g}, {:.6g})", open,
                    balance.size(), at->x(), at->y(), at->z()),
        "close the holes, weld the vertices and make all triangles turn the same way");
  }
  const double volume = mesh_mass(mesh).volume;
  if (volume < 0) {
    return refuse(fmt::format("the surface is inside out: its volume is {:.6g} m^3", volume),
                  "flip its triangles: counter-clockwise seen from outside");
  }
  const Vec3 first = mesh.vertices.front();
  double size = 0;
  for (const Vec3& v : mesh.vertices) size = std::max(size, (v - first).norm());
  if (volume < 1e-12 * size * size * size)
    return refuse("the surface encloses no volume", "give a solid with a thickness");
  return ok();
}

MassProperties mesh_mass(const TriangleMesh& mesh) {
  // Signed tetrahedra from the first vertex, which keeps rounding small for meshes far from the origin. For a
  // tetrahedron with apex 0: integral of x x^T = volume / 20 (s s^T + a a^T + b b^T + c c^T), s = a + b + c.
  MassProperties mass;
  const Vec3 apex = mesh.vertices.front();
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - apex, b = mesh.vertices[t[1]] - apex, c = mesh.vertices[t[2]] - apex,
               s = a + b + c;
    const double volume = a.dot(b.cross(c)) / 6;
    mass.volume += volume;
    first += volume / 4 * s;
    second += volume / 20 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Vec3 arm = first / mass.volume;
  mass.centre = apex + arm;
  second -= mass.volume * arm * arm.transpose();
  mass.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return mass;
}

}  // namespace ballast::geometry
