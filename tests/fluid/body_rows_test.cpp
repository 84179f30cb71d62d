// The bodies' part of the pressure system against brute force over all pairs of particles and samples.
#include "fluid_server/pressure/body_rows.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

constexpr double kPitch = 0.05, kStep = 2e-3;

/// Two free boxes so close to each other that particles feel both, in disordered water, and a tank.
struct TwoBoxes {
  explicit TwoBoxes(int threads) {
    scene.world.spacing = kPitch;
    scene.models = {tank({1, 1, 1}), box_body("one", {0.2, 0.2, 0.2}, 300, {0.4, 0.5, 0.5}),
                    box_body("two", {0.2, 0.15, 0.3}, 2000, {0.66, 0.5, 0.5})};
    bodies = *make_bodies(scene);
    coordinates = Coordinates::make({{-0.3, -0.3, -0.3}, {1.3, 1.3, 1.3}}, {});
    samples = Samples::make(scene, bodies, coordinates, kernel.support - kPitch / 2);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> u(-0.2, 0.2);
    Particles before;
    for (double x = 0.2; x < 0.9; x += kPitch)
      for (double y = 0.3; y < 0.75; y += kPitch)
        for (double z = 0.3; z < 0.75; z += kPitch) {
          const Vec3 at = Vec3(x, y, z) + kPitch * Vec3(u(random), u(random), u(random));
          bool inside = false;
          for (std::size_t b = 1; b < 3; ++b) inside |= bodies[b].solid.distance(at - bodies[b].pose.position) < 0;
          if (inside) continue;
          const Fixed3 f = coordinates.to_fixed(at);
          before.record.push_back({f[0], f[1], f[2], 0, 0, 0, 0, float(kPitch * kPitch * kPitch)});
          before.id.push_back(static_cast<std::uint32_t>(before.id.size()));
        }
    for (std::size_t b = 0; b < 3; ++b) states.push_back(initial_state(scene.models[b], bodies[b], {0, 0, 0}));
    for (std::size_t b = 1; b < 3; ++b) {
      const MassProperties& mass = bodies[b].solid.mass_properties();
      const double density = scene.models[b].density;
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> mobility(states[b].mobility);
      mobility.setZero();
      mobility.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / (density * mass.volume);
      mobility.bottomRightCorner<3, 3>() = (density * mass.inertia).inverse();
    }
    constants.kernel = kernel;
    constants.threads = threads;
    items = std::make_unique<Neighbourhood>(coordinates, kernel.support, 3, threads);
    items->set_static_samples(samples.fixed());
    samples.place(states, coordinates, threads);
    items->rebuild(before, particles, samples.moving(), samples.first_moving);
    build_lists(*items, constants);
    ItemExtras extras;
    extras.density.assign(1, 1000.f);
    gather_samples(*items, extras, constants, sums);
    for (const SampleSums& s : sums) inverse_w.push_back(s.w > 0 ? 0.7f / s.w : 0.f);
    sum_rows(*items, extras, constants, row_sums, pairs);
    rows.build(*items, samples, states, sums, inverse_w, pairs, constants, kStep);
  }
  std::vector<float> random_pressures() const {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> u(-1, 1);
    std::vector<float> p(particles.size());
    for (float& x : p) x = u(random);
    return p;
  }
  Vec3 place(const Record& r) const { return coordinates.to_metres(r.x, r.y, r.z); }
  /// Wrench on a body by these pressures, by the formula: pairs, and what its samples extrapolate.
  Vector6 wrench(std::uint32_t body, std::span<const float> p) const {
    Vector6 sum = Vector6::Zero();
    for (std::uint32_t s = 0; s < samples.size(); ++s) {
      if (samples.body[s] != body || s < samples.first_moving) continue;
      const Vec3 at = Vec3::Map(states[body].position) + samples.local[s].cast<double>();
      double w = 0, wp = 0;
      Vec3 g = Vec3::Zero(), pg = Vec3::Zero();
      for (std::size_t f = 0; f < particles.size(); ++f) {
        const Vec3 r = at - place(particles.record[f]);
        if (r.norm() >= kernel.support) continue;
        const double volume = particles.record[f].volume;
        w += volume * kernel.value(r.norm()), wp += volume * kernel.value(r.norm()) * p[f];
        g += volume * kernel.slope_over_r(r.norm()) * r, pg += volume * kernel.slope_over_r(r.norm()) * p[f] * r;
      }
      if (w == 0) continue;
      const Vec3 force = -samples.volume[s] * (pg + 0.7 * wp / w * g);
      sum.head<3>() += force;
      sum.tail<3>() += samples.local[s].cast<double>().cross(force);
    }
    return sum;
  }

  Kernel kernel{KernelKind::kCubic, 3, 2 * kPitch};
  Scene scene;
  std::vector<Body> bodies;
  Coordinates coordinates;
  Samples samples;
  Particles particles;
  std::vector<exchange::BodyState> states;
  PassConstants constants;
  std::unique_ptr<Neighbourhood> items;
  std::vector<SampleSums> sums;
  std::vector<float> inverse_w;
  std::vector<RowSums> row_sums;
  KeptPairs pairs;
  BodyRows rows;
};

TEST(BodyRows, MoveEachBodyAsTheForcesOnItsSamplesDo) {
  const TwoBoxes boxes(2);
  const std::vector<float> p = boxes.random_pressures();
  std::vector<Vector6> y;
  boxes.rows.reduce(p, y);
  EXPECT_FALSE(boxes.rows.moves(0));
  for (std::uint32_t b = 1; b < 3; ++b) {
    const Vector6 expected = kStep * (mobility_of(boxes.states[b]) * boxes.wrench(b, p)),
                  got = boxes.rows.motion(b, y[b]);
    EXPECT_GT(expected.norm(), 0);
    EXPECT_LT((got - expected).norm(), 1e-4 * expected.norm())
        << got.transpose() << " instead of " << expected.transpose();
  }
}

TEST(BodyRows, SpreadIsTheTransposeOfReduce) {
  const TwoBoxes boxes(2);
  const std::vector<float> p = boxes.random_pressures();
  std::vector<Vector6> y, z(3, Vector6::Zero());
  boxes.rows.reduce(p, y);
  for (int c = 0; c < 6; ++c) z[1][c] = c - 2.5, z[2][c] = 1.5 - c * c;
  std::vector<float> out(p.size(), 0.f);
  boxes.rows.spread(z, out);
  double left = 0, right = 0, scale = 0;
  for (std::size_t b = 1; b < 3; ++b) left += y[b].dot(z[b]);
  for (std::size_t f = 0; f < p.size(); ++f) right += double(p[f]) * out[f], scale += std::abs(double(p[f]) * out[f]);
  EXPECT_NEAR(left, right, 1e-5 * scale);
}

/// T = 1 + U^T D^-1 U, by products with U alone.
TEST(BodyRows, SolveInvertsTheSystemOfTheBodiesThatShareParticles) {
  TwoBoxes boxes(2);
  std::vector<float> diagonal(boxes.particles.size());
  for (std::size_t f = 0; f < diagonal.size(); ++f) diagonal[f] = 1e-13f * float(1 + f % 7);
  boxes.rows.factor(diagonal);
  std::vector<Vector6> y(3, Vector6::Zero()), image;
  for (int c = 0; c < 6; ++c) y[1][c] = 1 + c, y[2][c] = 3 - c;
  const std::vector<Vector6> right = y;
  boxes.rows.solve(y);
  std::vector<float> scaled(diagonal.size(), 0.f);
  boxes.rows.spread_scaled(y, diagonal, scaled);  // -D^-1 U y
  boxes.rows.reduce(scaled, image);
  for (std::size_t b = 1; b < 3; ++b) {
    const double size = image[b].norm() + y[b].norm();
    EXPECT_LT((y[b] - image[b] - right[b]).norm(), 1e-4 * size);
    EXPECT_GT(image[b].norm(), 0.1 * y[b].norm()) << "the water hardly matters: nothing is tested";
  }
}

TEST(BodyRows, DoNotDependOnTheNumberOfThreads) {
  const TwoBoxes one(1), three(3);
  const std::vector<float> p = one.random_pressures();
  std::vector<Vector6> a, b;
  one.rows.reduce(p, a);
  three.rows.reduce(p, b);
  for (std::size_t k = 1; k < 3; ++k) EXPECT_EQ(a[k], b[k]);
}

}  // namespace
}  // namespace ballast::fluid
