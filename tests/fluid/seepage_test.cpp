// Films between solids: closed forms for the lift and torque of a box that stands on a floor.
#include "fluid_server/boundary/seepage.h"

#include <gtest/gtest.h>

#include "tests/fluid/models.h"

namespace ballast::fluid {
namespace {

constexpr double kSpacing = 0.03, kSide = 0.3, kHeight = 0.15, kWeight = 9810;

/// A box `gap` above the floor of a tank, in its middle or at `x`; only samples within two spacings of its sides are
/// wet.
struct Standing {
  explicit Standing(double gap, double x = 0.6) {
    scene.world.spacing = kSpacing;
    scene.models = {tank({1.2, 1.2, 0.6}), box_body("box", {kSide, kSide, kHeight}, 500, {x, 0.6, gap + kHeight / 2})};
    bodies = *make_bodies(scene);
    const Coordinates coordinates = Coordinates::make({{-0.2, -0.2, -0.2}, {1.4, 1.4, 0.8}}, {});
    samples = Samples::make(scene, bodies, coordinates, 1.5 * kSpacing);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      states.push_back(initial_state(scene.models[b], bodies[b], scene.world.gravity));
    seepage = std::make_unique<Seepage>(scene, samples, bodies, kernel, Vec3(0, 0, -9.81), 1000);
  }
  /// `pressure` in the box's frame where it is wet.
  void solve(const std::function<double(const Vec3&)>& pressure) {
    seepage->solve(states, [&](std::uint32_t s) -> std::optional<Seepage::Wet> {
      const Vec3 x = samples.local[s].cast<double>();
      const double inside = kSide / 2 - x.cwiseAbs().head<2>().maxCoeff();
      if (inside < 2 * kSpacing)
        return Seepage::Wet{pressure(x), pressure(x), borne * kSpacing * kSpacing * Vec3(0, 0, 1)};
      return {};
    });
    const std::vector<Eigen::Matrix<double, 6, 1>> rest(2, Eigen::Matrix<double, 6, 1>::Zero());
    seepage->press(states, rest, 1e-3);
  }
  /// Lets forces move the box, but not turn it. Its mass, kg.
  double release() {
    const double mass = bodies[1].mass;
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> mobility(states[1].mobility);
    mobility.setZero();
    mobility.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() / mass;
    return mass;
  }
  Vec3 force(std::size_t body) const { return Vec3::Map(seepage->wrenches()[body].force); }
  Vec3 torque(std::size_t body) const { return Vec3::Map(seepage->wrenches()[body].torque); }
  double borne = 0;  // share of its area on which a sample is pressed upwards by particles
  Kernel kernel{KernelKind::kWendland, 3, 2.9 * kSpacing};
  Scene scene;
  std::vector<Body> bodies;
  Samples samples;
  std::vector<exchange::BodyState> states;
  std::unique_ptr<Seepage> seepage;
};

TEST(Seepage, StillWaterLiftsByItsPressureAtTheFloor) {
  Standing standing(0);
  constexpr double depth = 0.4;
  standing.solve([](const Vec3& x) { return kWeight * (depth - (x[2] + kHeight / 2)); });
  const double lift = kWeight * depth * kSide * kSide;
  EXPECT_NEAR(standing.force(1)[2], lift, 1e-6 * lift);
  EXPECT_LT(standing.force(1).head<2>().norm(), 1e-9 * lift);
  EXPECT_LT(standing.torque(1).norm(), 1e-6 * lift * kSide);
  EXPECT_LT((standing.force(0) + standing.force(1)).norm(), 1e-12 * lift) << "action is not reaction";
}

TEST(Seepage, ASlopeOfThePressureGoesThroughTheFilmAndTurnsTheBox) {
  Standing standing(0);
  constexpr double mean = 3000, slope = 8000;  // Pa, Pa/m
  standing.solve([](const Vec3& x) { return mean + slope * x[0] - kWeight * (x[2] + kHeight / 2); });
  const double lift = mean * kSide * kSide;
  EXPECT_NEAR(standing.force(1)[2], lift, 1e-6 * lift);
  // -integral of p x over the face, in cells of the first layer
  double moment = 0;
  const int n = static_cast<int>(std::lround(kSide / kSpacing));
  for (int i = 0; i < n; ++i) {
    const double x = (i + 0.5) * kSpacing - kSide / 2;
    moment -= slope * x * x * kSpacing * kSide;
  }
  EXPECT_NEAR(standing.torque(1)[1], moment, 1e-5 * std::abs(moment));
}

TEST(Seepage, FilmsBearNoTensionAndEndWhereParticlesFit) {
  Standing dry(0);
  dry.solve([](const Vec3&) { return -1000.0; });
  EXPECT_EQ(dry.force(1).norm(), 0);
  Standing apart(kSpacing);
  apart.solve([](const Vec3&) { return 1000.0; });
  EXPECT_EQ(apart.force(1).norm(), 0);
  Standing between(0.75 * kSpacing);
  between.solve([](const Vec3& x) { return 1000 - kWeight * x[2]; });
  Standing closed(0);
  closed.solve([](const Vec3& x) { return 1000 - kWeight * x[2]; });
  EXPECT_NEAR(between.force(1)[2], 0.5 * closed.force(1)[2], 1e-6 * closed.force(1)[2]);
}

TEST(Seepage, WhereParticlesPressNoFilmDoes) {
  Standing standing(0);
  standing.solve([](const Vec3&) { return 1000.0; });
  const double all = standing.force(1)[2];
  standing.borne = 0.8;
  standing.solve([](const Vec3&) { return 1000.0; });
  const double wet = 100 - 36;  // places of the face whose samples the particles reach: its two outer rings
  EXPECT_NEAR(standing.force(1)[2], all * (1 - wet / 100), 0.02 * all);
}

/// A film opens its gap as fast as water flows in, and no faster: v = h / l sqrt(2 p / rho).
TEST(Seepage, WaterHasToFlowIn) {
  Standing standing(0.2 * kSpacing);
  const double mass = standing.release();
  standing.solve([](const Vec3&) { return 1e6; });  // 1e6 Pa for 1 ms would give it 13 m/s
  const double fastest = (0.2 + 0.05) * kSpacing / (kSide / 2) * std::sqrt(2 * 1e6 / 1000);
  EXPECT_NEAR(standing.force(1)[2] / mass * 1e-3, fastest, 0.02 * fastest);
  Vec3::Map(standing.states[1].velocity) = Vec3(0, 0, 2 * fastest);
  standing.solve([](const Vec3&) { return 1e6; });
  EXPECT_EQ(standing.force(1)[2], 0);
}

/// Against floor and wall, drawn off the wall three times as fast as water flows in: it still lifts from the floor.
/// Less than all, for the places along the edge lie towards both.
TEST(Seepage, InACornerEachSideHasAFilmOfItsOwn) {
  Standing standing(0, kSide / 2);
  const auto still = [](const Vec3&) { return 1000.0; };
  standing.solve(still);
  const Vec3 held = standing.force(1);
  EXPECT_GT(held[0], 0);
  EXPECT_GT(held[2], 0);
  standing.release();
  Vec3::Map(standing.states[1].velocity) = Vec3(0.05, 0, 0);
  standing.solve(still);
  EXPECT_LT(standing.force(1)[0], 0.2 * held[0]);
  EXPECT_GT(standing.force(1)[2], 0.5 * held[2]);
}

/// Water at one pressure all around two boxes moves neither: what the sums over particles press, on a lattice of them
/// around both, and what the film presses, cancel. Particles beside the rim of the film reach round it.
TEST(Seepage, UniformPressureMovesNothing) {
  constexpr double pressure = 1000;
  // Shift of the boxes against the particles, spacings, and tolerance: cut columns of water are a coarse sum. Pressing
  // on the whole face instead would be 13 % too much; the lattice is good for 0.3 %.
  for (const auto& [shift, tolerance] : {std::pair(0.0, 3e-3), std::pair(0.25, 0.03)}) {
    Scene scene;
    scene.world.spacing = kSpacing;
    const Kernel kernel{KernelKind::kWendland, 3, 2.9 * kSpacing};
    const Vec3 size(0.3, 0.3, 0.24), middle(shift * kSpacing, shift * kSpacing, 0);
    scene.models = {box_body("low", size, 2000, middle - Vec3(0, 0, size[2] / 2)),
                    box_body("high", size, 2000, middle + Vec3(0, 0, size[2] / 2))};
    const std::vector<Body> bodies = *make_bodies(scene);
    const Coordinates coordinates = Coordinates::make({{-1, -1, -1}, {1, 1, 1}}, {});
    const Samples samples = Samples::make(scene, bodies, coordinates, 2.4 * kSpacing);
    std::vector<std::pair<Vec3, double>> water;  // places, and volumes outside of the boxes
    constexpr int n = 13;
    for (int i = -n; i < n; ++i)
      for (int j = -n; j < n; ++j)
        for (int k = -n; k < n; ++k) {
          const Vec3 x = kSpacing * Vec3(i + 0.5, j + 0.5, k + 0.5), from = (x - middle).cwiseAbs();
          const Vec3 deep = (Vec3(0.15, 0.15, 0.24) - from) / kSpacing;
          const double inside = (deep.array() + 0.5).max(0).min(1).prod();
          if (inside < 1) water.emplace_back(x, (1 - inside) * std::pow(kSpacing, 3));
        }
    std::vector<exchange::BodyState> states;
    for (std::size_t b = 0; b < 2; ++b) states.push_back(initial_state(scene.models[b], bodies[b], {0, 0, 0}));
    std::vector<Vec3> area(samples.size(), Vec3::Zero());
    Vec3 on_high = Vec3::Zero();
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const Vec3 at = Vec3::Map(states[samples.body[s]].position) + samples.local[s].cast<double>();
      for (const auto& [x, volume] : water)
        if (const double r = (at - x).norm(); r < kernel.support)
          area[s] -= samples.volume[s] * volume * kernel.slope_over_r(r) * (at - x);
      if (samples.body[s] == 1) on_high += 2 * pressure * area[s];
    }
    Seepage seepage(scene, samples, bodies, kernel, Vec3::Zero(), 1000);
    seepage.solve(states, [&](std::uint32_t s) -> std::optional<Seepage::Wet> {
      if (area[s].isZero(0)) return {};
      return Seepage::Wet{pressure, pressure, area[s]};
    });
    seepage.press(states, std::vector<Eigen::Matrix<double, 6, 1>>(2, Eigen::Matrix<double, 6, 1>::Zero()), 1e-3);
    const double face = pressure * size[0] * size[1];
    EXPECT_LT(on_high[2], -0.85 * face);
    EXPECT_NEAR(seepage.wrenches()[1].force[2], -on_high[2], tolerance * face) << "shift " << shift;
    EXPECT_LT(Vec3::Map(seepage.wrenches()[1].torque).norm(), 0.01 * face * size[0]);
  }
}

/// A sheet of water so thin that its samples bear none of its pressure still lifts a box that stands on the floor; from
/// particles pressed into an open gap nothing more is taken than they bear.
TEST(Seepage, AThinSheetLiftsWhereTheGapIsShut) {
  constexpr double seen = 2000, borne = 500, face = kSide * kSide;
  const auto lift = [&](double gap) {
    Standing standing(gap);
    standing.seepage->set_gravity(Vec3::Zero());
    standing.seepage->solve(standing.states, [&](std::uint32_t s) -> std::optional<Seepage::Wet> {
      const double inside = kSide / 2 - standing.samples.local[s].cast<double>().cwiseAbs().head<2>().maxCoeff();
      if (inside < kSpacing) return Seepage::Wet{borne, seen, Vec3::Zero()};
      return {};
    });
    standing.seepage->press(standing.states,
                            std::vector<Eigen::Matrix<double, 6, 1>>(2, Eigen::Matrix<double, 6, 1>::Zero()), 1e-3);
    return standing.force(1)[2];
  };
  EXPECT_NEAR(lift(0), seen * face, 1e-6 * seen * face);
  EXPECT_NEAR(lift(0.3 * kSpacing), borne * face, 1e-6 * seen * face);
}

/// Water at one edge only, air at the other three: pressure at the wet edge, none at the others, so the box is tipped.
TEST(Seepage, ARimInAirHasNoPressure) {
  Standing standing(0);
  constexpr double pressure = 1000;
  standing.seepage->solve(standing.states, [&](std::uint32_t s) -> std::optional<Seepage::Wet> {
    if (standing.samples.local[s][0] < -kSide / 2 + kSpacing) return Seepage::Wet{pressure, pressure, Vec3::Zero()};
    return {};
  });
  standing.seepage->press(standing.states,
                          std::vector<Eigen::Matrix<double, 6, 1>>(2, Eigen::Matrix<double, 6, 1>::Zero()), 1e-3);
  // Laplace on a square of which one side bears p, the others none: the mean is p / 4 (four such add up to p
  // everywhere), on the lattice a little more, since its outermost places are inside.
  const double face = pressure * kSide * kSide;
  EXPECT_GT(standing.force(1)[2], 0.2 * face);
  EXPECT_LT(standing.force(1)[2], 0.3 * face);
  EXPECT_GT(standing.torque(1)[1], 0.05 * face * kSide) << "lifted at the wet edge";
}

TEST(Seepage, WhatNoWaterReachesHasNoFilm) {
  Standing standing(0);
  standing.seepage->solve(standing.states, [](std::uint32_t) -> std::optional<Seepage::Wet> { return {}; });
  EXPECT_EQ(standing.force(1).norm(), 0);
}

}  // namespace
}  // namespace ballast::fluid
