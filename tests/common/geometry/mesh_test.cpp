// Meshes: files, exact integrals, distances and refusals.
#include <fstream>
#include <random>

#include "common/geometry/mesh_distance.h"
#include "tests/common/geometry/shapes.h"

namespace ballast::test {
namespace {

TEST(Mesh, CuboidFileBehavesLikeTheBox) {
  const TemporaryFile file(".obj", kCuboidObj);
  const Solid m = solid(mesh(file.path()), 3, 0.1, true), b = solid(box({2, 3, 4}));
  EXPECT_NEAR(m.mass_properties().volume, 24, 1e-12);
  EXPECT_LT((m.mass_properties().centre - Vec3(2, 2.5, 0)).norm(), 1e-12);
  EXPECT_LT((m.mass_properties().inertia - b.mass_properties().inertia).norm(), 1e-10);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-3, 3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p(unit(random), unit(random), unit(random));
    EXPECT_NEAR(m.distance(p), b.distance(p), 1e-12) << p.transpose();
  }
}

TEST(Mesh, TetrahedronHasItsClosedFormMass) {
  // Right-angled tetrahedron with legs 1 m: volume 1/6, centre 1/4; each moment about the origin is 1/60 + 1/60, and
  // the parallel axes take away 2 V / 16.
  const TemporaryFile file(
      ".stl",
      "solid t\n"
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n"
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n"
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n"
      "facet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n"
      "endsolid t\n");
  const MassProperties mass = solid(mesh(file.path())).mass_properties();
  EXPECT_NEAR(mass.volume, 1.0 / 6, 1e-14);
  EXPECT_LT((mass.centre - Vec3::Constant(0.25)).norm(), 1e-14);
  EXPECT_NEAR(mass.inertia(0, 0), 2.0 / 60 - 2.0 / 6 / 16, 1e-14);
  EXPECT_NEAR(mass.inertia(0, 1), -(1.0 / 120 - 1.0 / 6 / 16), 1e-14);
}

// A torus of radii 0.5 and 0.2: it has saddles and a hole, where a wrong sign of the distance would show.
TriangleMesh torus() {
  TriangleMesh m;
  constexpr std::uint32_t kAround = 64, kTube = 32;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    for (std::uint32_t j = 0; j < kTube; ++j) {
      const double u = 2 * kPi * i / kAround, v = 2 * kPi * j / kTube, r = 0.5 + 0.2 * std::cos(v);
      m.vertices.emplace_back(r * std::cos(u), r * std::sin(u), 0.2 * std::sin(v));
      const auto at = [](std::uint32_t a, std::uint32_t b) { return a % kAround * kTube + b % kTube; };
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

TEST(Mesh, DistanceToATorusIsRight) {
  const TemporaryFile file(".obj", obj_text(torus()));
  const Solid s = solid(mesh(file.path()));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-0.8, 0.8);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p(unit(random), unit(random), 0.5 * unit(random));
    const double exact = std::hypot(std::hypot(p.x(), p.y()) - 0.5, p.z()) - 0.2;
    // Facets lie up to 0.7 (1 - cos(pi / 64)) + 0.2 (1 - cos(pi / 32)) = 0.0018 inside.
    EXPECT_NEAR(s.distance(p), exact, 0.002) << p.transpose();
  }
  // Samples fill two layers of 0.05 of the tube: 2 pi^2 R (r^2 - (r - 0.1)^2), less what the facets cut off.
  const auto samples = s.samples(0.05, 0.1, kEverywhere);
  const double layers = 2 * kPi * kPi * 0.5 * (0.04 - 0.01);
  EXPECT_NEAR(total_volume(samples), layers, 0.015 * layers);
  const auto full = s.samples(0.05, 1, kEverywhere);
  EXPECT_NEAR(total_volume(full), s.mass_properties().volume, 1e-12);
}

TEST(Mesh, TrianglesThatOverlapABoxAreThoseOfBruteForce) {
  const TriangleMesh t = solid(mesh(TemporaryFile(".obj", obj_text(torus())).path())).surface();
  const geometry::MeshDistance tree(t);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-0.8, 0.8);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p(unit(random), unit(random), 0.3 * unit(random)), half = 0.1 * Vec3(1 + unit(random), 1, 1);
    std::vector<std::uint32_t> found, expected;
    tree.overlapping(p - half, p + half, found);
    for (std::uint32_t k = 0; k < t.triangles.size(); ++k) {
      const Vec3 &a = t.vertices[t.triangles[k][0]], &b = t.vertices[t.triangles[k][1]],
                 &c = t.vertices[t.triangles[k][2]];
      const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
      if ((low.array() <= (p + half).array()).all() && (high.array() >= (p - half).array()).all())
        expected.push_back(k);
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

TEST(Mesh, SectionOfDimensionTwoIsTheCutAtYZero) {
  const TemporaryFile file(".obj", obj_text(torus()));
  // The torus cut at y = 0: two discs of radius 0.2 at x = -0.5 and 0.5 (32 chords).
  const Solid s = solid(mesh(file.path()), 2, 0.05);
  const double chords = std::sin(kPi / 16) / (kPi / 16), area = 2 * kPi * 0.04 * chords;
  EXPECT_NEAR(s.mass_properties().volume, area, 1e-7);  // assimp keeps single precision
  EXPECT_LT(s.mass_properties().centre.norm(), 1e-9);
  const double about_y = area * (0.25 + 0.04 / 2);
  EXPECT_NEAR(s.mass_properties().inertia(1, 1), about_y, 0.02 * about_y);
  EXPECT_NEAR(s.distance({0.5, 7, 0}), -0.2, 0.001);
  EXPECT_NEAR(s.distance({0, 0, 0}), 0.3, 0.001);
  EXPECT_NEAR(s.distance({-0.5, 0, 0.5}), 0.3, 0.001);
  const auto samples = s.samples(0.05, 1, kEverywhere);
  EXPECT_NEAR(total_volume(samples), area, 1e-7);
  for (const SurfaceSample& x : samples) EXPECT_EQ(x.position.y(), 0);
}

TEST(Mesh, ScaleMayMirror) {
  const TemporaryFile file(".obj", kCuboidObj);
  const Solid s = solid(mesh(file.path(), {-0.5, 1, 2}));
  EXPECT_NEAR(s.mass_properties().volume, 24, 1e-12);
  EXPECT_LT((s.mass_properties().centre - Vec3(-1, 2.5, 0)).norm(), 1e-12);
}

void expect_refusal(const Shape& shape, const std::string& words, int dimension = 3) {
  const Result<Solid> made = Solid::make(shape, dimension, 0.1, false);
  ASSERT_FALSE(made) << words;
  EXPECT_NE(made.error().what.find(words), std::string::npos) << made.error().text();
  EXPECT_FALSE(made.error().cure.empty());
  EXPECT_EQ(made.error().exit_code, kBadInput);
}

TEST(Mesh, RefusesWhatIsNotASolid) {
  expect_refusal(mesh("no/such/file.obj"), "no/such/file.obj");
  const std::string cuboid = kCuboidObj;
  const TemporaryFile open(".obj", cuboid.substr(0, cuboid.rfind("f ")));
  expect_refusal(mesh(open.path()), "surface is open: 4 of");
  std::string turned = cuboid.substr(0, cuboid.find('f'));
  turned += "f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n";
  const TemporaryFile inside_out("_turned.obj", turned);
  expect_refusal(mesh(inside_out.path()), "inside out");
  const TemporaryFile one_side("_side.obj", cuboid.substr(0, cuboid.rfind("f ")) + "f 8 5 1 4\n");
  expect_refusal(mesh(one_side.path()), "surface is open");
  const TemporaryFile good("_good.obj", kCuboidObj);
  expect_refusal(mesh(good.path(), {1, 0, 1}), "scale");
  expect_refusal(mesh(good.path()), "does not cross the plane y = 0", 2);
}

/// A finding of the fuzz target, without the first byte, which tells it the format.
std::string finding(const char* name) {
  std::ifstream seed(std::string(BALLAST_SOURCE_DIR "/tests/fuzz/corpus/mesh/") + name, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(seed), {}};
  EXPECT_GT(bytes.size(), 100u) << name;
  return bytes.substr(1);
}

/// assimp's PLY reader seeks for ever.
TEST(Mesh, RefusesADamagedFileThatIsNeverReadToItsEnd) {
  const TemporaryFile endless("_endless.ply", finding("endless_ply"));
  expect_refusal(mesh(endless.path()), "does not come to an end");
}

/// An assertion of assimp ends the process that reads.
TEST(Mesh, RefusesADamagedFileThatCrashesItsReader) {
  const TemporaryFile crashes("_crashes.ply", finding("aborts_the_reader"));
  expect_refusal(mesh(crashes.path()), "its reader crashed (Aborted)");
}

/// The reader's memory is bounded: ten million indices of nothing are refused, whatever assimp makes of them.
TEST(Mesh, RefusesAFileThatAnnouncesMoreThanThereIs) {
  const TemporaryFile huge("_huge.ply",
                           "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
                           "property float z\nend_header\n0 0 0\n");
  expect_refusal(mesh(huge.path()), "cannot read mesh");
}

}  // namespace
}  // namespace ballast::test
