// ParaView files read back byte by byte, independently of the writer.
#include "common/output/vtk.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>

namespace ballast::output {
namespace {

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The values of a named appended array, found as the format describes it: offset after the underscore, length, data.
template <class T>
std::vector<T> array_of(const std::string& file, const std::string& name) {
  std::smatch match;
  const std::string head = file.substr(0, file.find("<AppendedData"));
  if (!std::regex_search(head, match, std::regex("Name=\"" + name + "\"[^>]*offset=\"([0-9]+)\""))) return {};
  const std::size_t start = file.find('_', file.find("<AppendedData")) + 1 + std::stoul(match[1]);
  std::uint64_t bytes = 0;
  std::memcpy(&bytes, file.data() + start, sizeof bytes);
  std::vector<T> out(bytes / sizeof(T));
  std::memcpy(out.data(), file.data() + start + sizeof bytes, bytes);
  return out;
}

struct Vtk : ::testing::Test {
  std::string folder = (std::filesystem::temp_directory_path() / ("ballast_vtk_" + std::to_string(getpid()))).string();
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }
};

TEST_F(Vtk, ParticlesComeBackAsTheyWere) {
  const std::vector<float> x = {0, 1, 2, 3, 4, 5}, v = {-1, 0, 1, 7, 8, 9}, p = {100, 200}, rho = {1000, 1001};
  ASSERT_TRUE(write_particles_vtp(folder + "/p.vtp", {x, v, p, rho}));
  const std::string file = slurp(folder + "/p.vtp");
  EXPECT_NE(file.find("NumberOfPoints=\"2\" NumberOfVerts=\"2\""), std::string::npos);
  EXPECT_EQ(array_of<float>(file, "Points"), x);
  EXPECT_EQ(array_of<float>(file, "velocity"), v);
  EXPECT_EQ(array_of<float>(file, "pressure"), p);
  EXPECT_EQ(array_of<float>(file, "density"), rho);
  EXPECT_EQ(array_of<std::int64_t>(file, "connectivity"), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(array_of<std::int64_t>(file, "offsets"), (std::vector<std::int64_t>{1, 2}));
  EXPECT_FALSE(std::filesystem::exists(folder + "/p.vtp.part"));
}

TEST_F(Vtk, BodiesArePosedAndClosed) {
  Shape shape;
  shape.size = {2, 2, 2};
  std::vector<Body> bodies;
  bodies.push_back({std::move(*Solid::make(shape, 3, 0.1, true)), {}});
  Pose pose;
  pose.position = {10, 0, 0};
  ASSERT_TRUE(write_bodies_vtp(folder + "/b.vtp", bodies, std::span(&pose, 1)));
  const std::string file = slurp(folder + "/b.vtp");
  const auto points = array_of<float>(file, "Points");
  const auto corners = array_of<std::int64_t>(file, "connectivity");
  ASSERT_EQ(corners.size() % 3, 0u);
  // Volume by the divergence theorem: 8 m^3, wherever the box is.
  double volume = 0;
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    Eigen::Matrix3d m;
    for (int k = 0; k < 3; ++k) {
      const float* c = &points[3 * static_cast<std::size_t>(corners[t + static_cast<std::size_t>(k)])];
      m.col(k) << c[0], c[1], c[2];
    }
    volume += m.determinant() / 6;
  }
  EXPECT_NEAR(volume, 8, 1e-4);
  for (std::size_t i = 0; i < points.size(); i += 3) EXPECT_NEAR(std::abs(points[i] - 10), 1, 1e-6);
}

TEST_F(Vtk, SeriesNamesAFileForEveryTime) {
  VtkSeries series(folder + "/vtk");
  const std::vector<float> x = {0, 1, 2};
  ASSERT_TRUE(series.add(0, {x, {}, {}, {}}, {}, {}));
  ASSERT_TRUE(series.add(0.25, {x, {}, {}, {}}, {}, {}));
  const std::string index = slurp(folder + "/vtk/particles.pvd");
  EXPECT_NE(index.find("timestep=\"0.25\" part=\"0\" file=\"particles_00001.vtp\""), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(folder + "/vtk/particles_00001.vtp"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/vtk/bodies.pvd"));
}

TEST_F(Vtk, AFolderThatCannotBeMadeIsAnError) {
  VtkSeries series("/proc/nowhere/vtk");
  EXPECT_FALSE(series.add(0, {}, {}, {}));
}

}  // namespace
}  // namespace ballast::output
