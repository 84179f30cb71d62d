// From models to bodies and records: masses, refusals with names and cures, overlaps, the manifest.
#include "common/geometry/bodies.h"

#include <cstring>

#include "tests/common/geometry/shapes.h"

namespace ballast::test {
namespace {

const Pose kHere;
Pose at(double x, double y, double z) { return {{x, y, z}, Quat::Identity()}; }

TEST(Overlap, OfSpheresIsWhatTheirRadiiExceedTheirDistanceBy) {
  const Solid a = solid(sphere(0.5)), b = solid(sphere(0.3));
  const Vec3 direction = Vec3(1, 2, -2) / 3;
  for (const double distance : {0.4, 0.6, 0.75, 0.799}) {
    const Pose pose{distance * direction, Quat(Eigen::AngleAxisd(1, Vec3::UnitX()))};
    EXPECT_NEAR(overlap_depth(a, kHere, b, pose, 0.02), 0.8 - distance, 1e-5) << distance;
    EXPECT_NEAR(overlap_depth(b, pose, a, kHere, 0.02), 0.8 - distance, 1e-5) << distance;
  }
  EXPECT_EQ(overlap_depth(a, kHere, b, at(0.8, 0, 0), 0.02), 0);
  EXPECT_EQ(overlap_depth(a, kHere, b, at(0.9, 0, 0), 0.02), 0);
}

TEST(Overlap, OfBoxesIsTheShallowestCommonEdge) {
  const Solid a = solid(box({1, 1, 1})), b = solid(box({1, 1, 1}));
  EXPECT_NEAR(overlap_depth(a, kHere, b, at(0.9, 0.2, 0.3), 0.05), 0.1, 1e-6);
  EXPECT_EQ(overlap_depth(a, kHere, b, at(1, 0, 0), 0.05), 0) << "faces that touch";
  EXPECT_EQ(overlap_depth(a, kHere, b, at(1, 1, 1), 0.05), 0) << "corners that touch";
  // An edge turned by 45 degrees reaches sqrt(2) / 2 from the centre.
  const Pose turned{{1.15, 0, 0}, Quat(Eigen::AngleAxisd(kPi / 4, Vec3::UnitZ()))};
  EXPECT_NEAR(overlap_depth(a, kHere, b, turned, 0.05), 0.5 + std::sqrt(0.5) - 1.15, 1e-5);
  // A thin rod through the middle of a plate: no corner of either lies inside the other.
  const Solid rod = solid(box({0.1, 0.1, 3})), plate = solid(box({2, 2, 0.2}));
  EXPECT_GT(overlap_depth(rod, kHere, plate, kHere, 0.05), 0.04);
}

TEST(Overlap, WithPlanesTanksAndMeshes) {
  EXPECT_NEAR(overlap_depth(solid(plane({0, 0, 1})), kHere, solid(sphere(0.5)), at(0, 0, 0.45), 0.05), 0.05, 1e-5);
  EXPECT_EQ(overlap_depth(solid(plane({0, 0, 1})), kHere, solid(box({1, 1, 1})), at(0, 0, 0.5), 0.05), 0);
  const Solid tank = solid(open_box({2, 2, 2}, 0.1)), cube = solid(box({0.5, 0.5, 0.5}));
  EXPECT_EQ(overlap_depth(tank, kHere, cube, at(0.25, 1, 0.25), 0.05), 0) << "it stands in the corner of the room";
  EXPECT_NEAR(overlap_depth(tank, kHere, cube, at(0.22, 1, 0.25), 0.05), 0.03, 1e-6);
  const TemporaryFile file(".obj", kCuboidObj);
  EXPECT_NEAR(overlap_depth(solid(mesh(file.path())), kHere, cube, at(3.2, 2, 0), 0.1), 0.05, 1e-6);
  const Solid disc = solid(sphere(0.5), 2), other = solid(sphere(0.5), 2);
  EXPECT_NEAR(overlap_depth(disc, kHere, other, at(0.6, 0, 0.6), 0.02), 1 - std::sqrt(0.72), 1e-5);
}

Model model(const std::string& name, const Shape& shape, const Pose& pose, Motion motion = Motion::kDynamic) {
  Model m;
  m.name = name;
  m.shape = shape;
  m.pose = pose;
  m.motion = motion;
  m.density = motion == Motion::kDynamic ? 500 : 0;
  m.place = {"test.yaml", 7, 5};
  return m;
}

Scene scene_of(std::vector<Model> models, int dimension = 3) {
  Scene scene;
  scene.world.dimension = dimension;
  scene.world.spacing = 0.05;
  scene.models = std::move(models);
  return scene;
}

void expect_refusal(const Scene& scene, const std::vector<std::string>& words) {
  const auto made = make_bodies(scene);
  ASSERT_FALSE(made) << words.front();
  EXPECT_EQ(made.error().where, "test.yaml:7:5");
  EXPECT_EQ(made.error().exit_code, kBadInput);
  for (const std::string& word : words) {
    EXPECT_NE(made.error().text().find(word), std::string::npos) << word << " in: " << made.error().text();
  }
}

TEST(Bodies, RefusalsNameTheModelAndTheCure) {
  expect_refusal(scene_of({model("floor", plane({0, 0, 1}), kHere)}), {"'floor'", "infinite", "static"});
  Model massless = model("boat", open_box({1, 1, 1}), kHere);
  massless.density = 0;
  expect_refusal(scene_of({massless}), {"'boat'", "neither mass nor density"});
  expect_refusal(scene_of({model("b", box({1, 0, 1}), kHere)}), {"'b'", "edge along y of a box is 0 m"});
  expect_refusal(scene_of({model("s", sphere(-1), kHere)}), {"'s'", "radius of a sphere is -1 m"});
  expect_refusal(scene_of({model("c", cylinder(1, 0), kHere)}), {"'c'", "length of a cylinder is 0 m"});
  expect_refusal(scene_of({model("none", compound({}), kHere)}), {"'none'", "without parts"});
  expect_refusal(scene_of({model("p", compound({{plane({0, 0, 1}), kHere}}), kHere)}), {"'p'", "part 1", "infinite"});
  expect_refusal(scene_of({model("m", mesh("nowhere.stl"), kHere)}), {"'m'", "nowhere.stl"});
  expect_refusal(scene_of({model("t", box({1, 1, 1}), {{0, 0, 0}, Quat(Eigen::AngleAxisd(0.1, Vec3::UnitX()))})}, 2),
                 {"'t'", "x-z plane", "about y"});
}

TEST(Bodies, OverlapsAreRefusedWithNamesDepthAndCure) {
  const Shape cube = box({1, 1, 1});
  expect_refusal(scene_of({model("low", cube, kHere), model("high", cube, at(0, 0, 0.9))}),
                 {"'low'", "'high'", "0.1 m", "world.allow_overlap", "test.yaml:7:5"});
  Scene allowed = scene_of({model("low", cube, kHere), model("high", cube, at(0, 0, 0.9))});
  allowed.world.allow_overlap = true;
  EXPECT_TRUE(make_bodies(allowed));
  Scene joined = scene_of({model("low", cube, kHere), model("high", cube, at(0, 0, 0.9))});
  joined.joints.emplace_back();
  joined.joints[0].parent = "low";
  joined.joints[0].child = "high";
  EXPECT_TRUE(make_bodies(joined));
  EXPECT_TRUE(
      make_bodies(scene_of({model("a", cube, kHere, Motion::kStatic), model("b", cube, kHere, Motion::kStatic)})));
  EXPECT_TRUE(make_bodies(scene_of({model("low", cube, kHere), model("high", cube, at(0, 0, 1))})))
      << "a stack touches";
  EXPECT_TRUE(make_bodies(scene_of({model("low", cube, kHere), model("high", cube, at(0, 0, 0.99995))})))
      << "1e-4 of the size is let through";
}

TEST(Bodies, MassComesFromDensityOrIsGiven) {
  Model given = model("given", sphere(0.5), at(5, 0, 0));
  given.density = 0;
  given.mass = 3;
  const auto bodies = make_bodies(scene_of({model("cube", box({1, 2, 3}), kHere), given}));
  ASSERT_TRUE(bodies) << bodies.error().text();
  EXPECT_DOUBLE_EQ((*bodies)[0].mass, 3000);
  EXPECT_NEAR((*bodies)[0].inertia(0, 0), 3000 * 13 / 12.0, 1e-9);
  EXPECT_DOUBLE_EQ((*bodies)[1].mass, 3);
  EXPECT_NEAR((*bodies)[1].inertia(2, 2), 0.4 * 3 * 0.25, 1e-12);
  const auto flat = make_bodies(scene_of({model("disc", sphere(0.5), at(0, 9, 0))}, 2));
  ASSERT_TRUE(flat);
  EXPECT_NEAR((*flat)[0].mass, 500 * kPi * 0.25, 1e-9) << "per metre of depth";
  EXPECT_EQ((*flat)[0].pose.position.y(), 0);
}

TEST(Manifest, HoldsEveryFieldOfBodiesJointsAndWorld) {
  Model crate = model("crate", compound({{box({1, 1, 1}), at(2, 0, 0)}, {sphere(0.5), at(4, 0, 0)}}), at(0, 0, 3));
  crate.velocity = {1, 2, 3};
  crate.angular_velocity = {4, 5, 6};
  crate.friction = 0.7;
  crate.restitution = 0.6;
  Model gate = model("gate", box({1, 1, 1}), at(20, 0, 0), Motion::kPrescribed);
  gate.prescription = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, 10, 0.25, 11, 12};
  Scene scene = scene_of({crate, gate, model("tank", open_box({9, 9, 9}), at(50, 0, 0), Motion::kStatic)});
  scene.coupling.substeps = 3;
  scene.joints.emplace_back();
  scene.joints[0].name = "hinge";
  scene.joints[0].kind = JointKind::kRevolute;
  scene.joints[0].parent = "world";
  scene.joints[0].child = "gate";
  scene.joints[0].upper = 0.5;
  const auto bodies = make_bodies(scene);
  ASSERT_TRUE(bodies) << bodies.error().text();
  const exchange::Manifest m = make_manifest(scene, *bodies);
  ASSERT_EQ(m.bodies.size(), 3U);
  const exchange::BodyRecord& b = m.bodies[0];
  EXPECT_STREQ(b.name, "crate");
  const double ball = kPi / 6, centre = (2 + 4 * ball) / (1 + ball);
  EXPECT_NEAR(b.mass, 500 * (1 + ball), 1e-9);
  EXPECT_NEAR(b.position[0], centre, 1e-12);
  EXPECT_NEAR(b.position[2], 3, 1e-12);
  EXPECT_EQ(b.velocity[2], 3);
  EXPECT_EQ(b.angular_velocity[0], 4);
  EXPECT_EQ(b.friction, 0.7);
  EXPECT_EQ(b.restitution, 0.6);
  EXPECT_NEAR(b.volume, 1 + ball, 1e-12);
  EXPECT_EQ(b.shape_count, 2U);
  EXPECT_NEAR(m.shapes[0].position[0], 2 - centre, 1e-12) << "shapes are posed in the body frame";
  EXPECT_EQ(m.shapes[1].type, exchange::ShapeType::kSphere);
  EXPECT_EQ(m.shapes[1].radius, 0.5);
  const exchange::BodyRecord& g = m.bodies[1];
  EXPECT_EQ(g.motion, exchange::BodyMotion::kPrescribed);
  EXPECT_EQ(g.mass, 0);
  EXPECT_EQ(g.drive_velocity[0], 1);
  EXPECT_EQ(g.drive_angular_velocity[1], 5);
  EXPECT_EQ(g.drive_amplitude[2], 9);
  EXPECT_EQ(g.drive_frequency, 10);
  EXPECT_EQ(g.drive_phase, 0.25);
  EXPECT_EQ(g.drive_start, 11);
  EXPECT_EQ(g.drive_stop, 12);
  EXPECT_EQ(m.bodies[2].first_shape, 3U);
  EXPECT_EQ(m.bodies[2].shape_count, 5U) << "floor and four walls";
  EXPECT_EQ(m.joints[0].parent, -1);
  EXPECT_EQ(m.joints[0].child, 1);
  EXPECT_EQ(m.joints[0].upper, 0.5);
  EXPECT_TRUE(std::isinf(m.joints[0].lower));
  EXPECT_EQ(m.joints[0].type, exchange::JointType::kRevolute);
  EXPECT_EQ(m.world.substeps, 3U);
  EXPECT_NEAR(m.world.length_scale, std::cbrt(1 + ball), 1e-12);
}

TEST(Manifest, DiscsOfDimensionTwoAreCylindersAlongY) {
  Shape drum = sphere(1, 0.2);
  const Scene scene =
      scene_of({model("disc", cylinder(0.3, 9), kHere), model("drum", drum, kHere, Motion::kStatic)}, 2);
  const auto bodies = make_bodies(scene);
  ASSERT_TRUE(bodies) << bodies.error().text();
  const exchange::Manifest m = make_manifest(scene, *bodies);
  const exchange::ShapeRecord& s = m.shapes[0];
  EXPECT_EQ(s.type, exchange::ShapeType::kCylinder);
  EXPECT_EQ(s.length, 1);
  const Vec3 axis = Quat(s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]) * Vec3::UnitZ();
  EXPECT_NEAR(std::abs(axis.y()), 1, 1e-12);
  ASSERT_EQ(m.shapes[1].type, exchange::ShapeType::kMesh);
  EXPECT_EQ(m.shapes[1].vertex_count * 3, m.vertices.size());
  EXPECT_EQ(m.shapes[1].triangle_count * 3, m.triangles.size());
  for (const std::uint32_t v : m.triangles) EXPECT_LT(v, m.shapes[1].vertex_count);
}

}  // namespace
}  // namespace ballast::test
