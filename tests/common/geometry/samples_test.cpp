// Samples: exact volumes, layers half a pitch inside, even spacing, continuation of the fluid's lattice.
#include <algorithm>

#include "tests/common/geometry/shapes.h"

namespace ballast::test {
namespace {

constexpr double kSpacing = 0.1;

struct Sampled {
  const char* name;
  Shape shape;
  int dimension;
};

std::vector<Sampled> primitives() {
  return {{"rectangle", box({1, 1, 0.8}), 2},     {"disc", sphere(0.4), 2},
          {"ring", sphere(0.7, 0.3), 2},          {"tank2", open_box({1.2, 1, 0.8}), 2},
          {"box", box({1, 0.6, 0.8}), 3},         {"sphere", sphere(0.4), 3},
          {"hollow sphere", sphere(0.5, 0.3), 3}, {"cylinder", cylinder(0.4, 0.9), 3},
          {"capsule", capsule(0.4, 0.7), 3},      {"drum", cylinder(0.4, 0.6, 0.3), 3},
          {"tank", open_box({1.2, 0.6, 0.8}), 3}, {"lidded", open_box({1, 0.6, 0.8}, 0, true), 3}};
}

std::vector<double> nearest_neighbours(const std::vector<SurfaceSample>& samples) {
  std::vector<double> nearest;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double best = 1e300;
    for (std::size_t j = 0; j < samples.size(); ++j) {
      if (i != j) best = std::min(best, (samples[i].position - samples[j].position).norm());
    }
    nearest.push_back(best);
  }
  return nearest;
}

TEST(Samples, FullSolidsGetTheirExactVolume) {
  for (const Sampled& c : primitives()) {
    const Solid s = solid(c.shape, c.dimension, kSpacing);
    const auto samples = s.samples(kSpacing, 10, kEverywhere);
    EXPECT_NEAR(total_volume(samples), s.mass_properties().volume, 1e-12) << c.name;
    // Means of their positions: the layers are symmetric up to the spirals of spheres.
    Vec3 centre = Vec3::Zero();
    for (const SurfaceSample& sample : samples) centre += sample.volume * sample.position;
    centre /= total_volume(samples);
    EXPECT_LT((centre - s.mass_properties().centre).norm(), 0.05 * kSpacing) << c.name;
  }
}

TEST(Samples, TwoLayersFillExactlyTwoPitches) {
  const double r = 0.8, d = 0.1;
  const auto disc = solid(sphere(r), 2, d).samples(d, 2 * d, kEverywhere);
  EXPECT_NEAR(total_volume(disc), kPi * (r * r - 0.6 * 0.6), 1e-12);
  const auto ball = solid(sphere(r), 3, d).samples(d, 2 * d, kEverywhere);
  EXPECT_NEAR(total_volume(ball), 4.0 / 3 * kPi * (r * r * r - 0.6 * 0.6 * 0.6), 1e-12);
  const auto cube = solid(box({1, 1, 1}), 3, d).samples(d, 2 * d, kEverywhere);
  EXPECT_NEAR(total_volume(cube), 1 - 0.6 * 0.6 * 0.6, 1e-12);
  const auto can = solid(cylinder(r, 1), 3, d).samples(d, 2 * d, kEverywhere);
  EXPECT_NEAR(total_volume(can), kPi * (r * r - 0.6 * 0.6 * 0.6), 1e-12);
  const auto pill = solid(capsule(r, 1), 3, d).samples(d, 2 * d, kEverywhere);
  const auto pill_volume = [](double a) { return 4.0 / 3 * kPi * a * a * a + kPi * a * a; };
  EXPECT_NEAR(total_volume(pill), pill_volume(r) - pill_volume(0.6), 1e-12);
}

// Of the integral of |x|^2 over a solid the samples show all but what their pieces, about cubes, have around their
// centroids. Midway between the faces of their layers round ones would show up to 2 % less.
TEST(Samples, OfSimpleShapesStandAtTheCentroidsOfWhatTheyStandFor) {
  for (const Sampled& c : primitives()) {
    if (c.shape.kind == ShapeKind::kOpenBox && !c.shape.lid) continue;  // its centre is not the origin
    const Solid s = solid(c.shape, c.dimension, kSpacing, true);
    double shown = 0;
    for (const SurfaceSample& sample : s.samples(kSpacing, 10, kEverywhere))
      shown += sample.volume * (sample.position.squaredNorm() + c.dimension / 12.0 * kSpacing * kSpacing);
    const Eigen::Matrix3d inertia = s.mass_properties().inertia;
    const double whole = c.dimension == 2 ? inertia(1, 1) : 0.5 * inertia.trace();
    EXPECT_NEAR(shown, whole, 4e-3 * whole) << c.name;
  }
}

TEST(Samples, LieOnLayersAboutHalfAPitchInside) {
  for (const Sampled& c : primitives()) {
    const Solid s = solid(c.shape, c.dimension, kSpacing);
    const bool flat = c.shape.kind == ShapeKind::kBox || c.shape.kind == ShapeKind::kOpenBox;
    for (const SurfaceSample& sample : s.samples(kSpacing, 0.3, kEverywhere)) {
      const double depth = -s.distance(sample.position);
      EXPECT_NEAR(sample.depth, depth, 1e-12) << c.name;
      EXPECT_GT(depth, (flat ? 0.49 : 0.47) * kSpacing) << c.name;  // pitch 0.1; centroids of round layers lie higher
      EXPECT_TRUE(c.dimension == 3 || sample.position.y() == 0) << c.name;
      EXPECT_NEAR(sample.normal.norm(), 1, 1e-9) << c.name;
      // From the sample along the normal, the surface is `depth` away; below an edge or a corner the normal is the mean
      // of two or three faces', and at most 1 - 1 / sqrt(3) of the depth is left.
      const double left = -s.distance(sample.position + depth * sample.normal);
      EXPECT_LT(left, 0.4227 * depth) << c.name;
      EXPECT_GT(left, -1e-4) << c.name;
    }
  }
}

// Whatever their radius: a sphere with one layer of samples, three quarters of a spacing deep, sank a third too fast.
// Two layers in little more than a spacing begin a quarter of one deep, two in almost two and a half 0.62.
TEST(Samples, OfRoundSolidsBeginAboutHalfASpacingDeep) {
  for (double r = 0.7; r < 4; r += 0.01) {
    for (const Sampled& c : std::vector<Sampled>{{"disc", sphere(r), 2},
                                                 {"sphere", sphere(r), 3},
                                                 {"cylinder", cylinder(r, 10), 3},
                                                 {"capsule", capsule(r, 10), 3}}) {
      double nearest = 1e300;
      for (const SurfaceSample& sample : solid(c.shape, c.dimension, 1).samples(1, 10, kEverywhere))
        if (std::abs(sample.position.z()) < 4) nearest = std::min(nearest, sample.depth);  // not at the cylinder's ends
      EXPECT_GT(nearest, 0.24) << c.name << " of radius " << r;
      EXPECT_LT(nearest, 0.63) << c.name << " of radius " << r;
    }
  }
}

TEST(Samples, AreAboutOneSpacingApart) {
  for (const Sampled& c : primitives()) {
    const auto samples = solid(c.shape, c.dimension, kSpacing).samples(kSpacing, 0.3, kEverywhere);
    const auto nearest = nearest_neighbours(samples);
    EXPECT_GT(*std::min_element(nearest.begin(), nearest.end()), 0.6 * kSpacing) << c.name;
    EXPECT_LT(*std::max_element(nearest.begin(), nearest.end()), 1.4 * kSpacing) << c.name;
  }
}

TEST(Samples, GeneralMethodSpreadsThemEvenly) {
  const Part one{sphere(0.4), {}}, two{box({0.5, 0.5, 0.5}), {{0.4, 0, 0}, Quat::Identity()}};
  for (const Sampled& c :
       std::vector<Sampled>{{"union", compound({one, two}), 3}, {"union of dimension 2", compound({one, two}), 2}}) {
    const Solid s = solid(c.shape, c.dimension, kSpacing);
    const auto samples = s.samples(kSpacing, 0.2, kEverywhere);
    const auto nearest = nearest_neighbours(samples);
    EXPECT_GT(*std::min_element(nearest.begin(), nearest.end()), 0.6 * kSpacing) << c.name;
    EXPECT_LT(*std::max_element(nearest.begin(), nearest.end()), 1.4 * kSpacing) << c.name;
    const double cell = c.dimension == 2 ? kSpacing * kSpacing : kSpacing * kSpacing * kSpacing;
    EXPECT_NEAR(total_volume(samples) / static_cast<double>(samples.size()), cell, 0.2 * cell) << c.name;
    for (const SurfaceSample& sample : samples) {
      EXPECT_LT(s.distance(sample.position), 0) << c.name;
      EXPECT_LT(sample.volume, 2 * cell) << c.name;
    }
    // The outer layer dominates and sits half a spacing deep.
    const auto outer = std::count_if(samples.begin(), samples.end(), [](const SurfaceSample& x) {
      return std::abs(x.depth - 0.5 * kSpacing) < 0.15 * kSpacing;
    });
    EXPECT_GT(outer, static_cast<long>(samples.size() / 2)) << c.name;
  }
}

TEST(Samples, SmallAndThinSolidsAreFilledExactly) {
  for (const double size : {0.02, 0.05, 0.1, 0.17, 0.24}) {
    for (const Sampled& c : std::vector<Sampled>{
             {"sphere", sphere(size / 2), 3},
             {"disc", sphere(size / 2), 2},
             {"capsule", capsule(size / 2, 0.5), 3},
             {"plate", box({1, 1, size}), 3},
             {"rod", cylinder(size / 2, 1), 3},
             {"rotated plate",
              compound({{box({0.5, 0.5, size}), {{0, 0, 0}, Quat(Eigen::AngleAxisd(0.5, Vec3::UnitY()))}}}), 3}}) {
      const Solid s = solid(c.shape, c.dimension, kSpacing);
      const auto samples = s.samples(kSpacing, 0.25, kEverywhere);
      ASSERT_FALSE(samples.empty()) << c.name << " " << size;
      EXPECT_NEAR(total_volume(samples), s.mass_properties().volume, 1e-12) << c.name << " " << size;
    }
  }
}

TEST(Samples, TankContinuesTheLatticeOfItsInside) {
  const double d = 0.1;
  const auto samples = solid(open_box({1, 0.5, 0.6}, 0.2), 3, d).samples(d, 0.2, kEverywhere);
  // Inside 10 x 5 x 6 cells, two layers at the sides and below: 14 x 9 x 8 less the inside.
  EXPECT_EQ(samples.size(), 14U * 9 * 8 - 10 * 5 * 6);
  for (const SurfaceSample& s : samples) {
    EXPECT_NEAR(s.volume, d * d * d, 1e-15);
    for (int a = 0; a < 3; ++a) {
      const double index = s.position[a] / d - 0.5;
      EXPECT_NEAR(index, std::round(index), 1e-9);
    }
    EXPECT_LT(s.position.z(), 0.6);
  }
}

TEST(Samples, ThinWallsClipTheLastLayer) {
  const double d = 0.1, wall = 0.17;
  const Solid s = solid(open_box({1, 1, 1}, wall), 2, d);
  const auto samples = s.samples(d, 0.3, kEverywhere);
  EXPECT_NEAR(total_volume(samples), s.mass_properties().volume, 1e-12);
  EXPECT_NEAR(s.mass_properties().volume, 2 * wall + wall * (1 + 2 * wall), 1e-12);
}

TEST(Samples, ThickWallsAreFilledFromBothSidesOnly) {
  // Room 2 x 2 in walls of 1 m. Left out is what lies 0.2 or more from the outside (and the rim) and from the room.
  const auto samples = solid(open_box({2, 1, 2}, 1), 2, 0.1).samples(0.1, 0.2, kEverywhere);
  EXPECT_NEAR(total_volume(samples), (4 * 3 - 2 * 2) - (3.6 * 2.6 - 2.4 * 2.0), 1e-9);
  for (const SurfaceSample& s : samples) EXPECT_LT(s.depth, 0.3);
}

TEST(Samples, PlaneFillsItsWindow) {
  const Box3 window{{-1, -2, -1}, {1, 2, 1}};
  const auto samples = solid(plane({0, 0, 1}), 3).samples(0.1, 0.25, window);
  EXPECT_EQ(samples.size(), 20U * 40 * 3);
  for (const SurfaceSample& s : samples) EXPECT_NEAR(s.depth, -s.position.z(), 1e-12);
  const auto slanted = solid(plane({1, 0, 1}), 2).samples(0.1, 0.2, window);
  for (const SurfaceSample& s : slanted) EXPECT_EQ(s.position.y(), 0);
  // A strip 0.2 deep along the diagonal of the square, 2 sqrt 2 long, less its slanted ends.
  EXPECT_NEAR(total_volume(slanted), 0.2 * 2 * std::sqrt(2) - 0.04, 0.02);
}

TEST(Samples, WindowCutsAndNothingDependsOnTheRun) {
  const Box3 window{{-0.2, -1, -0.3}, {0.7, 1, 0.1}};
  for (const Shape& shape : {sphere(0.5), capsule(0.3, 0.4)}) {
    const Solid s = solid(shape);
    const auto all = s.samples(0.1, 0.3, kEverywhere), cut = s.samples(0.1, 0.3, window);
    ASSERT_FALSE(cut.empty());
    EXPECT_LT(cut.size(), all.size());
    for (const SurfaceSample& x : cut) {
      for (int a = 0; a < 3; ++a) EXPECT_TRUE(x.position[a] >= window.min[a] && x.position[a] <= window.max[a]);
    }
    const auto again = solid(shape).samples(0.1, 0.3, kEverywhere);
    ASSERT_EQ(again.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(again[i].position, all[i].position);
  }
}

// Gradient of the two-dimensional Wendland C2 kernel of support H, 7 / (pi H^2) (1 - q)^4 (1 + 4 q).
Vec3 kernel_gradient(const Vec3& r, double support, int dimension) {
  const double q = r.norm() / support;
  if (q >= 1 || q <= 0) return Vec3::Zero();
  const double scale = dimension == 2 ? 7 / (kPi * support * support) : 21 / (2 * kPi * support * support * support);
  return -20 * scale * q * std::pow(1 - q, 3) / support * r.normalized();
}

TEST(Samples, SumOfGradientsVanishesBesideTheWallsOfATank) {
  for (const int dimension : {2, 3}) {
    const double d = 0.1, support = 2.6 * d;
    const int n = 8;
    const auto wall = solid(open_box({n * d, n * d, n * d}), dimension, d).samples(d, support - 0.5 * d, kEverywhere);
    std::vector<std::pair<Vec3, double>> all;
    for (const SurfaceSample& s : wall) all.emplace_back(s.position, s.volume);
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j < (dimension == 2 ? 1 : n); ++j) {
        for (int i = 0; i < n; ++i) {
          all.emplace_back(Vec3((i + 0.5) * d, dimension == 2 ? 0 : (j + 0.5) * d, (k + 0.5) * d),
                           dimension == 2 ? d * d : d * d * d);
        }
      }
    }
    // Along the floor, up a side and in the corner, below the free surface.
    for (const Vec3& at :
         {Vec3(0.05, 0.45, 0.05), Vec3(0.45, 0.45, 0.05), Vec3(0.05, 0.45, 0.35), Vec3(0.75, 0.05, 0.15)}) {
      const Vec3 p(at.x(), dimension == 2 ? 0 : at.y(), at.z());
      Vec3 sum = Vec3::Zero();
      double magnitude = 0;
      for (const auto& [x, volume] : all) {
        const Vec3 g = volume * kernel_gradient(p - x, support, dimension);
        sum += g;
        magnitude += g.norm();
      }
      EXPECT_LT(sum.norm(), 1e-12 * magnitude) << p.transpose();
    }
  }
}

}  // namespace
}  // namespace ballast::test
