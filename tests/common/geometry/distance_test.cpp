// Signed distances against brute force over dense points of the true surface, and rooms of containers.
#include <functional>
#include <random>

#include "tests/common/geometry/shapes.h"

namespace ballast::test {
namespace {

struct Case {
  const char* name;
  Solid solid;
  std::vector<Vec3> surface;  // dense points, each parametrised by hand below
  std::function<bool(const Vec3&)> inside;
};

constexpr double kStep = 0.02;

// Points of a flat rectangle of edges u and v.
void patch(std::vector<Vec3>& out, const Vec3& corner, const Vec3& u, const Vec3& v) {
  const int nu = static_cast<int>(std::ceil(u.norm() / kStep)), nv = static_cast<int>(std::ceil(v.norm() / kStep));
  for (int i = 0; i <= nu; ++i) {
    for (int j = 0; j <= nv; ++j) out.push_back(corner + i * u / nu + j * v / nv);
  }
}
void box_sides(std::vector<Vec3>& out, const Vec3& lo, const Vec3& hi) {
  const Vec3 x(hi.x() - lo.x(), 0, 0), y(0, hi.y() - lo.y(), 0), z(0, 0, hi.z() - lo.z());
  patch(out, lo, y, z), patch(out, lo + x, y, z), patch(out, lo, x, z), patch(out, lo + y, x, z), patch(out, lo, x, y);
}
// Band of a surface of revolution between (r0, z0) and (r1, z1).
void band(std::vector<Vec3>& out, double r0, double z0, double r1, double z1) {
  const int n = std::max(1, static_cast<int>(std::ceil(std::hypot(r1 - r0, z1 - z0) / kStep)));
  for (int i = 0; i <= n; ++i) {
    const double r = r0 + (r1 - r0) * i / n, z = z0 + (z1 - z0) * i / n;
    const int m = 1 + static_cast<int>(2 * kPi * r / kStep);
    for (int k = 0; k < m; ++k) out.emplace_back(r * std::cos(2 * kPi * k / m), r * std::sin(2 * kPi * k / m), z);
  }
}
void arc(std::vector<Vec3>& out, double r, double centre_z, double from, double to) {
  const int n = 1 + static_cast<int>(r * (to - from) / kStep);
  for (int i = 0; i <= n; ++i) {
    const double a = from + (to - from) * i / n;
    band(out, r * std::cos(a), centre_z + r * std::sin(a), r * std::cos(a), centre_z + r * std::sin(a));
  }
}
bool in_box(const Vec3& p, const Vec3& lo, const Vec3& hi) {
  return (p - lo).minCoeff() > 0 && (hi - p).minCoeff() > 0;
}

void compare(const Case& c) {
  const Box3 b = c.solid.bounds();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-0.25, 1.25);
  for (int n = 0; n < 300; ++n) {
    Vec3 p = b.min;
    for (int a = 0; a < 3; ++a) p[a] += unit(random) * (b.max - b.min)[a];
    double nearest = 1e300;
    for (const Vec3& s : c.surface) nearest = std::min(nearest, (s - p).squaredNorm());
    nearest = std::sqrt(nearest);
    const double distance = c.solid.distance(p);
    EXPECT_EQ(distance < 0, c.inside(p)) << c.name << " at " << p.transpose();
    // The points are at most kStep apart, so one lies within g = kStep / sqrt 2 of the true foot; on a surface of
    // radius R bending away its square is d^2 + g^2 (1 + d / R) at most.
    const double g2 = kStep * kStep / 2 * (1 + std::abs(distance) / 0.3);
    EXPECT_GE(nearest, std::abs(distance) - 1e-12) << c.name << " at " << p.transpose();
    EXPECT_LE(nearest, std::sqrt(distance * distance + g2) + 1e-4) << c.name << " at " << p.transpose();
    // Normal: unit, and distance grows along it.
    const Vec3 normal = c.solid.normal(p);
    EXPECT_NEAR(normal.norm(), 1, 1e-9);
    EXPECT_GT(c.solid.distance(p + 1e-4 * normal), distance) << c.name << " at " << p.transpose();
  }
}

TEST(Distance, BoxAgreesWithBruteForce) {
  std::vector<Vec3> surface;
  const Vec3 half(0.5, 0.3, 0.4);
  box_sides(surface, -half, half);
  patch(surface, {-0.5, -0.3, 0.4}, {1, 0, 0}, {0, 0.6, 0});
  compare({"box", solid(box(2 * half)), surface, [=](const Vec3& p) { return in_box(p, -half, half); }});
}

TEST(Distance, OpenBoxAgreesWithBruteForce) {
  std::vector<Vec3> surface;
  const Vec3 size(1, 0.7, 0.5), w(0.2, 0.2, 0.2), top(0, 0, 0.5);
  box_sides(surface, Vec3::Zero(), size);
  box_sides(surface, -w, {1.2, 0.9, 0.5});
  patch(surface, Vec3(-0.2, -0.2, 0.5), {1.4, 0, 0}, {0, 0.2, 0}),
      patch(surface, Vec3(-0.2, 0.7, 0.5), {1.4, 0, 0}, {0, 0.2, 0});
  patch(surface, Vec3(-0.2, 0, 0.5), {0.2, 0, 0}, {0, 0.7, 0}),
      patch(surface, Vec3(1, 0, 0.5), {0.2, 0, 0}, {0, 0.7, 0});
  const Solid tank = solid(open_box(size, 0.2));
  compare({"open box", solid(open_box(size, 0.2)), surface, [=](const Vec3& p) {
             return in_box(p, -w, {1.2, 0.9, 0.5}) && !in_box(p, Vec3::Zero(), size);
           }});
  EXPECT_TRUE(tank.is_container());
  EXPECT_NEAR(tank.room_distance({0.1, 0.3, 0.4}), -0.1, 1e-12);
  EXPECT_NEAR(tank.room_distance({0.5, 0.3, 9}), -0.3, 1e-12) << "the room is unbounded above";
  EXPECT_NEAR(tank.room_distance({0.5, 0.3, -0.1}), 0.1, 1e-12);
}

TEST(Distance, RoundShapesAgreeWithBruteForce) {
  std::vector<Vec3> ball, can, pill, drum;
  arc(ball, 0.4, 0, -kPi / 2, kPi / 2);
  compare({"sphere", solid(sphere(0.4)), ball, [](const Vec3& p) { return p.norm() < 0.4; }});
  band(can, 0.4, -0.3, 0.4, 0.3), band(can, 0, 0.3, 0.4, 0.3), band(can, 0, -0.3, 0.4, -0.3);
  const auto in_can = [](const Vec3& p, double r, double h) {
    return std::hypot(p.x(), p.y()) < r && std::abs(p.z()) < h;
  };
  compare({"cylinder", solid(cylinder(0.4, 0.6)), can, [&](const Vec3& p) { return in_can(p, 0.4, 0.3); }});
  drum = can;
  band(drum, 0.5, -0.4, 0.5, 0.4), band(drum, 0, 0.4, 0.5, 0.4), band(drum, 0, -0.4, 0.5, -0.4);
  const Solid hollow = solid(cylinder(0.4, 0.6, 0.1));
  compare({"drum", solid(cylinder(0.4, 0.6, 0.1)), drum,
           [&](const Vec3& p) { return in_can(p, 0.5, 0.4) && !in_can(p, 0.4, 0.3); }});
  EXPECT_NEAR(hollow.room_distance({0, 0, 0.2}), -0.1, 1e-12);
  arc(pill, 0.3, 0.4, 0, kPi / 2), arc(pill, 0.3, -0.4, -kPi / 2, 0), band(pill, 0.3, -0.4, 0.3, 0.4);
  compare({"capsule", solid(capsule(0.3, 0.8)), pill, [](const Vec3& p) {
             const Vec3 q(p.x(), p.y(), std::max(0.0, std::abs(p.z()) - 0.4));
             return q.norm() < 0.3;
           }});
  const Solid shell = solid(sphere(0.4, 0.1));
  EXPECT_TRUE(shell.is_container());
  EXPECT_NEAR(shell.distance({0.3, 0, 0}), 0.1, 1e-12);
  EXPECT_NEAR(shell.distance({0.42, 0, 0}), -0.02, 1e-12);
  EXPECT_NEAR(shell.distance({0.6, 0, 0}), 0.1, 1e-12);
  EXPECT_NEAR(shell.room_distance({0.3, 0, 0}), -0.1, 1e-12);
}

TEST(Distance, DimensionTwoIgnoresY) {
  for (const Shape& shape :
       {box({1, 0.1, 1}), sphere(0.4), sphere(0.4, 0.1), cylinder(0.4, 0.1), open_box({1, 0.1, 1})}) {
    const Solid s = solid(shape, 2);
    for (const double y : {-3.0, 0.4, 20.0}) EXPECT_EQ(s.distance({0.3, y, 0.2}), s.distance({0.3, 0, 0.2}));
    EXPECT_NEAR(s.normal({0.3, 1, 0.2}).y(), 0, 1e-12);
  }
}

TEST(Distance, UnionIsTheNearestPart) {
  const Quat turn(Eigen::AngleAxisd(0.4, Vec3::UnitY()));
  const Solid s = solid(compound({{sphere(0.3), {{1, 0, 0}, Quat::Identity()}}, {box({1, 1, 1}), {{-1, 0, 0}, turn}}}));
  const Vec3 p(0.6, 0.2, 0.1);
  EXPECT_NEAR(s.distance(p), (p - Vec3(1, 0, 0)).norm() - 0.3, 1e-12);
  const Vec3 above = Vec3(-1, 0, 0) + turn * Vec3(0.1, 0.2, 0.7);
  EXPECT_NEAR(s.distance(above), 0.2, 1e-12);
  EXPECT_LT((s.normal(above) - turn * Vec3::UnitZ()).norm(), 1e-6);
}

TEST(Distance, PlaneKeepsItsSolidBelowTheNormal) {
  const Solid s = solid(plane({0, 0, 2}));
  EXPECT_DOUBLE_EQ(s.distance({5, 6, 0.25}), 0.25);
  EXPECT_DOUBLE_EQ(s.distance({5, 6, -0.25}), -0.25);
  EXPECT_TRUE(s.surface().triangles.empty());
}

TEST(Surface, TrianglesCloseAndTurnOutwards) {
  // Volume under the triangles: exact for flat faces, and for 48 chords around the axis a factor sin(t)/t, t = pi / 24.
  const double chord = std::sin(kPi / 24) / (kPi / 24);
  const auto volume = [](const Solid& s) {
    double sum = 0;
    const TriangleMesh m = s.surface();
    for (const auto& [a, b, c] : m.triangles) sum += m.vertices[a].dot(m.vertices[b].cross(m.vertices[c])) / 6;
    return sum;
  };
  const auto expect = [&](const Shape& shape, int dimension, double factor, double tolerance) {
    const Solid s = solid(shape, dimension, 0.1);
    EXPECT_NEAR(volume(s), factor * s.mass_properties().volume, tolerance * s.mass_properties().volume);
  };
  expect(box({1, 2, 3}), 3, 1, 1e-12);
  expect(box({1, 2, 3}), 2, 1, 1e-12);
  expect(open_box({1, 2, 3}), 3, 1, 1e-12);
  expect(open_box({1, 2, 3}), 2, 1, 1e-12);
  expect(cylinder(0.4, 0.6), 3, chord, 1e-12);
  expect(cylinder(0.4, 0.6, 0.1), 3, chord, 1e-12);
  expect(sphere(0.4), 2, chord, 1e-12);
  expect(sphere(0.4, 0.2), 2, chord, 1e-12);
  expect(sphere(0.4), 3, chord, 5e-3);  // 24 chords from pole to pole take another 0.3 to 0.5 %
  expect(capsule(0.4, 1), 3, chord, 5e-3);
}

}  // namespace
}  // namespace ballast::test
