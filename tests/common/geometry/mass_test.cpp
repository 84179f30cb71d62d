// Volumes, centres and inertias against closed forms and against counting points.
#include <random>

#include "tests/common/geometry/shapes.h"

namespace ballast::test {
namespace {

void expect_inertia(const Eigen::Matrix3d& seen, const Vec3& diagonal, double tolerance) {
  const Eigen::Matrix3d wanted = diagonal.asDiagonal();
  EXPECT_LT((seen - wanted).norm(), tolerance * diagonal.norm()) << seen;
}

TEST(Mass, BoxIsTwelfthOfSquares) {
  const Solid s = solid(box({1, 2, 3}));
  EXPECT_DOUBLE_EQ(s.mass_properties().volume, 6);
  expect_inertia(s.mass_properties().inertia, {6 * 13 / 12.0, 6 * 10 / 12.0, 6 * 5 / 12.0}, 1e-14);
}

TEST(Mass, SphereIsTwoFifths) {
  const double r = 0.3, v = 4.0 / 3 * kPi * r * r * r;
  const Solid s = solid(sphere(r));
  EXPECT_NEAR(s.mass_properties().volume, v, 1e-15);
  expect_inertia(s.mass_properties().inertia, Vec3::Constant(0.4 * v * r * r), 1e-14);
}

TEST(Mass, CylinderHasAxisAlongZ) {
  const double r = 0.3, l = 2, v = kPi * r * r * l, across = v * (3 * r * r + l * l) / 12;
  const Solid s = solid(cylinder(r, l));
  EXPECT_NEAR(s.mass_properties().volume, v, 1e-15);
  expect_inertia(s.mass_properties().inertia, {across, across, v * r * r / 2}, 1e-14);
}

TEST(Mass, DiscOfDimensionTwoIsPerMetreAboutY) {
  const double r = 0.3;
  for (const Shape& shape : {sphere(r), cylinder(r, 7), capsule(r, 7)}) {
    const Solid s = solid(shape, 2);
    EXPECT_NEAR(s.mass_properties().volume, kPi * r * r, 1e-15);
    EXPECT_NEAR(s.mass_properties().inertia(1, 1), kPi * r * r * r * r / 2, 1e-15);
  }
}

TEST(Mass, RectangleOfDimensionTwoIgnoresY) {
  const Solid s = solid(box({2, 77, 3}), 2);
  EXPECT_DOUBLE_EQ(s.mass_properties().volume, 6);
  EXPECT_DOUBLE_EQ(s.mass_properties().inertia(1, 1), 6 * (4 + 9) / 12.0);
}

// Oracle: the fraction of random points inside, and their second moments.
void expect_by_counting(const Solid& s, double tolerance) {
  const Box3 b = s.bounds();
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  const int n = 400000;
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  const double cell = (b.max - b.min).prod() / n;
  for (int i = 0; i < n; ++i) {
    Vec3 p = b.min;
    for (int a = 0; a < 3; ++a) p[a] += unit(random) * (b.max - b.min)[a];
    if (s.distance(p) >= 0) continue;
    volume += cell;
    first += cell * p;
    second += cell * p * p.transpose();
  }
  const MassProperties& mass = s.mass_properties();
  const Vec3 centre = first / volume;
  second -= volume * centre * centre.transpose();
  const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  EXPECT_NEAR(mass.volume, volume, tolerance * volume);
  EXPECT_LT((mass.centre - centre).norm(), tolerance * (b.max - b.min).norm());
  EXPECT_LT((mass.inertia - inertia).norm(), 2 * tolerance * inertia.norm());
}

TEST(Mass, OtherShapesAgreeWithCounting) {
  // 400000 points: standard error of a volume that fills a third of its bounds is 0.2 %; five of them are allowed.
  expect_by_counting(solid(capsule(0.3, 0.8)), 0.01);
  expect_by_counting(solid(open_box({1, 0.7, 0.5}, 0.2)), 0.01);
  expect_by_counting(solid(open_box({1, 0.7, 0.5}, 0.2, true)), 0.01);
  expect_by_counting(solid(sphere(0.4, 0.2)), 0.01);
  expect_by_counting(solid(cylinder(0.4, 0.6, 0.2)), 0.01);
}

TEST(Mass, CompoundOfTouchingBoxesIsTheirSum) {
  // Two cubes of edge 1 make the box 2 x 1 x 1 with its centre at x = 0.5.
  const Solid s = solid(compound({{box({1, 1, 1}), {}}, {box({1, 1, 1}), {{1, 0, 0}, Quat::Identity()}}}));
  EXPECT_NEAR(s.mass_properties().volume, 2, 1e-14);
  EXPECT_NEAR(s.mass_properties().centre.x(), 0.5, 1e-14);
  expect_inertia(s.mass_properties().inertia, {2 * 2 / 12.0, 2 * 5 / 12.0, 2 * 5 / 12.0}, 1e-13);
}

TEST(Mass, OverlappingPartsCountOnce) {
  // Three boxes, all overlapping around the middle, whose union is the box 3 x 1 x 1; the overlap grid is exact here.
  const auto at = [](double x) { return Pose{{x, 0, 0}, Quat::Identity()}; };
  const Solid s = solid(compound({{box({2, 1, 1}), at(-0.5)}, {box({2, 1, 1}), at(0.5)}, {box({1, 1, 1}), at(0)}}));
  EXPECT_NEAR(s.mass_properties().volume, 3, 1e-9);
  expect_inertia(s.mass_properties().inertia, {3 * 2 / 12.0, 3 * 10 / 12.0, 3 * 10 / 12.0}, 1e-3);
  // Two spheres a radius apart: each loses a cap of height r / 2, so the union has 2 (4/3 - 5/24) pi r^3.
  const Solid two = solid(compound({{sphere(1), at(0)}, {sphere(1), at(1)}}));
  EXPECT_NEAR(two.mass_properties().volume, 2.25 * kPi, 1e-3 * 2.25 * kPi);
}

TEST(Mass, BodyFrameSitsAtTheCentreOfMassOfDynamicBodiesOnly) {
  const Shape shape = compound({{box({1, 1, 1}), {{3, 0, 0}, Quat::Identity()}}});
  EXPECT_NEAR(solid(shape, 3, 0.01, true).distance(Vec3::Zero()), -0.5, 1e-12);
  EXPECT_NEAR(solid(shape, 3, 0.01, false).distance(Vec3::Zero()), 2.5, 1e-12);
  const Pose turned{{1, 0, 0}, Quat(Eigen::AngleAxisd(kPi / 2, Vec3::UnitZ()))};
  const Pose at = body_pose(turned, solid(shape), Motion::kDynamic);
  EXPECT_LT((at.position - Vec3(1, 3, 0)).norm(), 1e-12);
  EXPECT_EQ(body_pose(turned, solid(shape), Motion::kStatic).position, Vec3(1, 0, 0));
}

}  // namespace
}  // namespace ballast::test
