// Contacts between two triangle meshes: what boxes do as primitives, boxes made of triangles must do too.
#include <array>
#include <chrono>
#include <cstring>
#include <numbers>
#include <random>

#include "tests/rigid/conformance.h"

namespace ballast::testing {

using MeshContacts = EveryEngine;
FOR_EVERY_ENGINE(MeshContacts);

namespace {

struct Mesh {
  std::vector<Vec> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Box with n x n squares on each face. Vertices of neighbouring faces are shared.
void add_box(Mesh& mesh, const Vec& size, int n = 1, bool inside_out = false) {
  const auto index = [&](const Vec& p) {
    const auto found = std::find(mesh.vertices.begin(), mesh.vertices.end(), p);
    const auto at = static_cast<std::uint32_t>(found - mesh.vertices.begin());
    if (found == mesh.vertices.end()) mesh.vertices.push_back(p);
    return at;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      const auto corner = [&](int i, int j) {
        Vec p = Vec::Zero();
        p[axis] = side, p[(axis + 1) % 3] = i, p[(axis + 2) % 3] = j;
        return index((p / n - Vec::Constant(0.5)).cwiseProduct(size));
      };
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          std::array<std::uint32_t, 4> q{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
          if ((side == 0) != inside_out) std::swap(q[1], q[3]);
          mesh.triangles.push_back({q[0], q[1], q[2]});
          mesh.triangles.push_back({q[0], q[2], q[3]});
        }
      }
    }
  }
}

void set_mesh(World& world, std::uint32_t body, const Mesh& mesh) {
  Manifest& m = world.manifest;
  ShapeRecord& s = world.shape(body, ShapeType::kMesh);
  s.first_vertex = static_cast<std::uint32_t>(m.vertices.size() / 3);
  s.vertex_count = static_cast<std::uint32_t>(mesh.vertices.size());
  s.first_triangle = static_cast<std::uint32_t>(m.triangles.size() / 3);
  s.triangle_count = static_cast<std::uint32_t>(mesh.triangles.size());
  for (const Vec& v : mesh.vertices) m.vertices.insert(m.vertices.end(), v.data(), v.data() + 3);
  for (const auto& t : mesh.triangles) m.triangles.insert(m.triangles.end(), t.begin(), t.end());
}

/// A box of 0.1 m edges unless told otherwise, as triangles (n > 0) or as primitive (n = 0).
std::uint32_t add(World& world, int n, BodyMotion motion, const Vec& position, const Vec& size = Vec::Constant(0.1),
                  double restitution = 0) {
  const double mass = motion == BodyMotion::kDynamic ? 1 : 0;
  if (n == 0) return world.box(motion, mass, size, position, 0.3, restitution);
  const Vec sq = size.cwiseProduct(size);
  const Vec inertia = mass / 12 * Vec(sq.y() + sq.z(), sq.x() + sq.z(), sq.x() + sq.y());
  const auto b = world.body(motion, mass, inertia, position, 0.3, restitution);
  Mesh mesh;
  add_box(mesh, size, n);
  set_mesh(world, b, mesh);
  return b;
}

/// A static closed box of walls around a room.
std::uint32_t add_room(World& world, BodyMotion motion, const Vec& position, const Vec& room, double wall) {
  const double mass = motion == BodyMotion::kDynamic ? 1 : 0;
  const auto b = world.body(motion, mass, Vec::Constant(mass * room.squaredNorm() / 10), position);
  Mesh mesh;
  add_box(mesh, room + Vec::Constant(2 * wall));
  add_box(mesh, room, 1, true);
  set_mesh(world, b, mesh);
  return b;
}

void turn(World& world, std::uint32_t b, const Eigen::Quaterniond& q) {
  double* o = world[b].orientation;
  o[0] = q.w(), o[1] = q.x(), o[2] = q.y(), o[3] = q.z();
}

Eigen::Quaterniond about(const Vec& axis, double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()));
}

TEST_P(MeshContacts, StacksOfMeshBoxesStandStill) {
  if (!has_contacts()) return;
  for (const int n : {1, 3}) {
    for (const double yaw : {0.0, 0.01, 10.0, 45.0}) {
      World world;
      add(world, n, BodyMotion::kStatic, {0, 0, -0.05}, {1, 1, 0.1});
      std::vector<std::uint32_t> boxes;
      for (int i = 0; i < 5; ++i) {
        boxes.push_back(add(world, n, BodyMotion::kDynamic, {0, 0, 0.05 + 0.1 * i}));
        turn(world, boxes.back(), about(Vec::UnitZ(), yaw * i));
      }
      Simulation run(GetParam(), world, 1e-3);
      run.to(2);
      double drift = 0;
      for (int i = 0; i < 5; ++i) {
        drift = std::max(drift, (run.position(boxes[i]) - Vec(0, 0, 0.05 + 0.1 * i)).norm());
        EXPECT_LT(run.velocity(boxes[i]).norm() + 0.1 * run.spin(boxes[i]).norm(), 1e-4);
      }
      figure("stack of 5, n = " + std::to_string(n) + ", yaw " + std::to_string(yaw) + ": drift m", drift, "1e-3");
      EXPECT_LT(drift, 1e-3) << "n = " << n << ", yaw " << yaw;
    }
  }
}

struct Fall {
  Vec position, up;
  double highest_energy = -HUGE_VAL, speed = 0, apex = 0;  // apex: after the first touch
};

/// A box falls from 0.2 m onto a static box.
Fall fall(const std::string& engine, int n, const Eigen::Quaterniond& pose, double restitution) {
  World world;
  add(world, n, BodyMotion::kStatic, {0, 0, -0.05}, {0.6, 0.6, 0.1}, restitution);
  const auto b = add(world, n, BodyMotion::kDynamic, {0, 0, 0.25}, {0.1, 0.08, 0.12}, restitution);
  turn(world, b, pose);
  Simulation run(engine, world, 1e-3);
  Fall result;
  const double start = run.energy();
  run.to(4, [&] {
    result.highest_energy = std::max(result.highest_energy, (run.energy() - start) / (kGravity * 0.2));
    if (run.time() > 0.25) result.apex = std::max(result.apex, run.position(b).z());
  });
  const Eigen::Matrix3d r = quat(run[b]).matrix();
  Eigen::Index axis = 0;
  r.row(2).cwiseAbs().maxCoeff(&axis);
  result.up = r.col(axis) * (r(2, axis) > 0 ? 1 : -1);
  result.position = run.position(b);
  result.speed = run.velocity(b).norm();
  return result;
}

TEST_P(MeshContacts, DroppedMeshBoxDoesWhatTheBoxDoes) {
  if (!has_contacts()) return;
  for (const double yaw : {0.0, 45.0}) {
    for (const double e : {0.0, 0.5}) {
      const Fall box = fall(GetParam(), 0, about(Vec::UnitZ(), yaw), e);
      const Fall mesh = fall(GetParam(), 1, about(Vec::UnitZ(), yaw), e);
      figure("drop, yaw " + std::to_string(yaw) + ": mesh - box m", (mesh.position - box.position).norm(), "1e-4");
      EXPECT_NEAR((mesh.position - box.position).norm(), 0, 1e-4) << "yaw " << yaw << ", e " << e;
      EXPECT_NEAR(mesh.apex, box.apex, 1e-3) << "yaw " << yaw << ", e " << e;
      EXPECT_LT(mesh.highest_energy, 1e-6);
    }
  }
}

// Falls on a corner or an edge are chaotic: not the path, but the end and the energy are what the box has.
TEST_P(MeshContacts, TumblingMeshBoxComesToRestFlatAndGainsNothing) {
  if (!has_contacts()) return;
  double gain = -1;
  for (const int n : {1, 3}) {
    for (const Vec& axis : {Vec(1, 0, 0), Vec(1, 1, 0), Vec(1, 2, 3), Vec(-2, 1, 0.5)}) {
      for (const double e : {0.0, 0.6}) {
        const Fall mesh = fall(GetParam(), n, about(axis, 35), e);
        gain = std::max(gain, mesh.highest_energy);
        EXPECT_GT(mesh.up.z(), 1 - 1e-5) << axis.transpose() << ", e " << e;
        const double z = mesh.position.z();
        EXPECT_LT(std::min({std::abs(z - 0.05), std::abs(z - 0.04), std::abs(z - 0.06)}), 1e-4) << z;
        EXPECT_LT(mesh.speed, 1e-4);
      }
    }
  }
  figure("tumbling mesh: energy gained / m g h", gain, "1e-6");
  EXPECT_LT(gain, 1e-6);
}

// Ridge on ridge, no vertex near: the normal is along the line of centres, so that the bar comes back as it came.
TEST_P(MeshContacts, CrossedBarsBounceOffEachOther) {
  if (!has_contacts()) return;
  for (const double crossing : {90.0, 40.0, 10.0}) {
    for (const int n : {1, 2}) {
      World world(0);
      const Vec size(0.6, 0.05, 0.05);
      const auto low = add(world, n, BodyMotion::kStatic, {0, 0, 0}, size, 1);
      const auto high = add(world, n, BodyMotion::kDynamic, {0.013, 0.007, 0.1}, size, 1);
      turn(world, low, about(Vec::UnitX(), 45));
      turn(world, high, about(Vec::UnitZ(), crossing) * about(Vec::UnitX(), 45));
      world.manifest.bodies[high].position[0] = world.manifest.bodies[high].position[1] = 0;
      put(world[high].velocity, {0, 0, -1});
      Simulation run(GetParam(), world, 1e-3);
      run.to(0.1);
      EXPECT_NEAR((run.velocity(high) - Vec(0, 0, 1)).norm(), 0, 1e-3) << crossing << " deg, n = " << n;
      EXPECT_LT(run.spin(high).norm(), 0.05);
    }
  }
}

TEST_P(MeshContacts, CollidingMeshBoxesFollowNewton) {
  if (!has_contacts()) return;
  for (const double e : {0.0, 0.5, 1.0}) {
    World world(0);
    const auto a = add(world, 1, BodyMotion::kDynamic, {0, 0, 0}, Vec::Constant(0.1), e);
    const auto b = add(world, 1, BodyMotion::kDynamic, {0.2503, 0, 0}, Vec::Constant(0.1), e);
    world[a].mass = 10;
    put(world[a].inertia, Vec::Constant(10 * 0.01 / 6));
    world[a].velocity[0] = 1;
    world[b].velocity[0] = -0.5;
    Simulation run(GetParam(), world, 1e-3);
    run.to(0.5);
    EXPECT_NEAR(run.velocity(a).x(), ((10 - e) * 1 + (1 + e) * -0.5) / 11, 1.5e-3) << e;
    EXPECT_NEAR(run.velocity(b).x(), ((1 - e * 10) * -0.5 + 10 * (1 + e)) / 11, 1.5e-3) << e;
    EXPECT_NEAR(10 * run.velocity(a).x() + run.velocity(b).x(), 9.5, 1e-9);
  }
}

TEST_P(MeshContacts, BoxFallsIntoTheCornerOfARoomAndRestsThere) {
  if (!has_contacts()) return;
  World world;
  put(world.manifest.world.gravity, {3, 2, -9});  // without friction it ends in the lowest corner
  add_room(world, BodyMotion::kStatic, {0, 0, 0}, {0.5, 0.5, 0.5}, 0.01);
  const auto b = add(world, 1, BodyMotion::kDynamic, {0, 0, 0});
  world[b].friction = 0;
  Simulation run(GetParam(), world, 1e-3);
  run.to(3);
  figure("box in a corner: error m", (run.position(b) - Vec(0.2, 0.2, -0.2)).norm(), "1e-4");
  EXPECT_NEAR((run.position(b) - Vec(0.2, 0.2, -0.2)).norm(), 0, 1e-4);
  EXPECT_LT(run.velocity(b).norm(), 1e-4);
}

// Walls of 1 mm one inside the other: the outer side of one is nearer to the inner side of the other than any depth.
TEST_P(MeshContacts, ThinWalledBoxesNestWithoutPushing) {
  if (!has_contacts()) return;
  World world;
  add_room(world, BodyMotion::kStatic, {0, 0, 0}, {0.2, 0.2, 0.2}, 0.001);
  const auto b = add_room(world, BodyMotion::kDynamic, {0.0195, 0.0195, -0.0198}, {0.158, 0.158, 0.158}, 0.001);
  Simulation run(GetParam(), world, 1e-3);
  run.to(1);
  EXPECT_NEAR((run.position(b) - Vec(0.0195, 0.0195, -0.02)).norm(), 0, 1e-4);
}

// Steps, tiles, ledges: the side of a box that overlaps a support by less than it stands on must not push.
TEST_P(MeshContacts, NarrowLedgeCarriesWithoutPushingSideways) {
  if (!has_contacts()) return;
  World world;
  add(world, 1, BodyMotion::kStatic, {-0.098, 0, -0.05});  // carries 2 mm
  add(world, 1, BodyMotion::kStatic, {0.05, 0, -0.05}, {0.196, 0.1, 0.1});
  const auto b = add(world, 1, BodyMotion::kDynamic, {0, 0, 0.05});
  Simulation run(GetParam(), world, 1e-3);
  run.to(2);
  EXPECT_NEAR((run.position(b) - Vec(0, 0, 0.05)).norm(), 0, 1e-4);
}

TEST_P(MeshContacts, OverlappingMeshesPartSlowly) {
  if (!has_contacts()) return;
  World world;
  add(world, 1, BodyMotion::kStatic, {0, 0, -0.05}, {1, 1, 0.1});
  const auto a = add(world, 1, BodyMotion::kDynamic, {0, 0, 0.05});
  const auto b = add(world, 1, BodyMotion::kDynamic, {0.07, 0.01, 0.05});
  Simulation run(GetParam(), world, 1e-3);
  double fastest = 0;
  run.to(3, [&] { fastest = std::max({fastest, run.velocity(a).norm(), run.velocity(b).norm()}); });
  figure("overlapping meshes: fastest while parting, m/s", fastest, "1");
  EXPECT_LT(fastest, 1);
  EXPECT_GT((run.position(a) - run.position(b)).norm(), 0.099);
}

TEST_P(MeshContacts, FastMeshDoesNotTunnelThroughAThinMeshPlate) {
  if (!has_contacts()) return;
  World world(0);
  add(world, 1, BodyMotion::kStatic, {0.5, 0, 0}, {0.005, 1, 1});
  const auto b = add(world, 1, BodyMotion::kDynamic, {0, 0, 0});
  world[b].velocity[0] = 300;
  Simulation run(GetParam(), world, 1e-3);
  run.to(0.05);
  EXPECT_LT(run.position(b).x(), 0.5 - 0.0025 - 0.05 + 1e-3);
}

TEST_P(MeshContacts, PrescribedMeshCarriesAMeshAtItsSpeed) {
  if (!has_contacts()) return;
  World world;
  const auto belt = add(world, 1, BodyMotion::kPrescribed, {0, 0, -0.1}, {4, 1, 0.2});
  world[belt].drive_velocity[0] = 1;
  const auto b = add(world, 1, BodyMotion::kDynamic, {0, 0, 0.05}, {0.2, 0.2, 0.1});
  Simulation run(GetParam(), world, 1e-3);
  run.to(0.2);
  EXPECT_NEAR(run.velocity(b).x(), 0.3 * kGravity * 0.2, 0.01);
  run.to(1);
  EXPECT_NEAR(run.velocity(b).x(), 1, 1e-3);
}

// In dimension 2 meshes come as the walls of their section, 1 m wide, without ends.
TEST_P(MeshContacts, SectionsInThePlaneStackToo) {
  if (!has_contacts()) return;
  World world(kGravity, 2);
  Mesh walls;
  add_box(walls, {0.1, 1, 0.1});
  const auto is_end = [&](const auto& t) {
    return walls.vertices[t[0]].y() == walls.vertices[t[1]].y() && walls.vertices[t[1]].y() == walls.vertices[t[2]].y();
  };
  std::erase_if(walls.triangles, is_end);
  for (int i = 0; i < 4; ++i) {
    const auto b = world.body(i == 0 ? BodyMotion::kStatic : BodyMotion::kDynamic, i == 0 ? 0 : 1,
                              {0, i == 0 ? 0 : 0.01 / 6, 0}, {0.01 * i, 0, 0.1 * i});
    set_mesh(world, b, walls);
  }
  Simulation run(GetParam(), world, 1e-3);
  run.to(2);
  for (int i = 1; i < 4; ++i) EXPECT_NEAR((run.position(i) - Vec(0.01 * i, 0, 0.1 * i)).norm(), 0, 1e-4) << i;
}

// Whatever bodies do, a closed room keeps them, energy falls and all come to rest. Found pairs that the search for
// pairs of bodies had lost, too.
TEST_P(MeshContacts, BodiesThrownAboutARoomStayInIt) {
  if (!has_contacts()) return;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto any = [&] { return Vec(u(random), u(random), u(random)); };
  for (int trial = 0; trial < 12; ++trial) {
    World world;
    add_room(world, BodyMotion::kStatic, {0, 0, 0}, {0.5, 0.4, 0.6}, 0.01);
    for (int i = 0; i < 4; ++i) {
      const Vec size = Vec(0.1, 0.08, 0.1) + 0.03 * any();
      const auto b = add(world, trial % 3, BodyMotion::kDynamic, {i % 2 ? 0.1 : -0.1, 0, i / 2 ? 0.12 : -0.12}, size,
                         0.4 * (trial % 3));
      turn(world, b, about(any(), 180 * u(random)));
      put(world[b].velocity, 5 * any());
      put(world[b].angular_velocity, 10 * any());
    }
    Simulation run(GetParam(), world, 1e-3);
    double energy = run.energy();
    const double start = energy;
    run.to(3, [&] { energy = std::max(energy, run.energy()); });
    // Pushing apart what overlaps lifts it a little.
    EXPECT_LT(energy, start + 0.03 * std::abs(start)) << "trial " << trial;
    for (std::size_t b = 1; b < 5; ++b) {
      const Vec beyond = run.position(b).cwiseAbs() - Vec(0.25, 0.2, 0.3);
      EXPECT_LT(beyond.maxCoeff(), 0) << "trial " << trial << ", body " << b;
      EXPECT_LT(run.velocity(b).norm(), 1e-3) << "trial " << trial << ", body " << b;
    }
  }
}

/// A heap of mesh boxes that is still collapsing.
World heap(int n) {
  World world;
  add_room(world, BodyMotion::kStatic, {0, 0, 0.6}, {0.3, 0.3, 1.2}, 0.02);
  for (int i = 0; i < 6; ++i) {
    turn(world, add(world, n, BodyMotion::kDynamic, {0.01 * i, 0.03 * (i % 3), 0.1 + 0.15 * i}, {0.1, 0.08, 0.06}, 0.2),
         about({1, 2, 0.5 * i}, 20 * i));
  }
  return world;
}

TEST_P(MeshContacts, HeapsRepeatTheSameBitsAlsoFromASavedState) {
  if (!has_contacts()) return;
  Simulation a(GetParam(), heap(2), 1e-3), b(GetParam(), heap(2), 1e-3), fresh(GetParam(), heap(2), 1e-3);
  const double start = a.energy();
  std::vector<std::byte> saved;
  for (int i = 0; i < 600; ++i) {
    if (i == 300) {
      a.engine().save(saved);
      ASSERT_TRUE(fresh.engine().restore(saved));
    }
    a.step(), b.step();
    ASSERT_EQ(std::memcmp(a.states.data(), b.states.data(), a.states.size() * sizeof(BodyState)), 0) << "step " << i;
    if (i < 300) continue;
    fresh.step();
    ASSERT_EQ(std::memcmp(a.states.data(), fresh.states.data(), a.states.size() * sizeof(BodyState)), 0)
        << "step " << i;
  }
  EXPECT_LT(a.energy(), start);
  for (int i = 1; i <= 6; ++i) EXPECT_GT(a.position(i).z(), 0.02);
}

// 3072 triangles on 3072: a step takes a few milliseconds (printed, since machines differ).
TEST_P(MeshContacts, FineMeshesRest) {
  if (!has_contacts()) return;
  World world;
  add(world, 16, BodyMotion::kStatic, {0, 0, -0.05});
  const auto b = add(world, 16, BodyMotion::kDynamic, {0.013, 0.017, 0.05});
  Simulation run(GetParam(), world, 1e-3);
  const auto start = std::chrono::steady_clock::now();
  run.to(0.5);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  figure("3072 triangles on 3072: ms per step", took.count() / 500 * 1e3, "5");
  EXPECT_NEAR((run.position(b) - Vec(0.013, 0.017, 0.05)).norm(), 0, 1e-4);
}

}  // namespace
}  // namespace ballast::testing
