// Every kind of expectation, once met and once missed, on paths whose answer is known.
#include "launch/expect.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "common/output/columns.h"

namespace ballast::launch {
namespace {

/// A tank and two balls of half the density of water; ball_a rises with 2 m/s^2 from rest, ball_b stands still.
struct Fixture : ::testing::Test {
  Scene scene;
  std::vector<Body> bodies;
  Table body_rows, probe_rows;
  nlohmann::json fluid = {{"particles", {{"fluid", 100}, {"lost", 0}}}}, rigid = nlohmann::json::object();
  std::optional<double> imbalance;
  std::vector<std::string> references;

  void SetUp() override {
    scene.world.spacing = 0.1;
    scene.fluids.push_back(Fluid{});
    Model tank;
    tank.name = "tank";
    tank.motion = Motion::kStatic;
    tank.shape.kind = ShapeKind::kOpenBox;
    tank.shape.size = {4, 4, 4};
    scene.models.push_back(tank);
    for (const char* name : {"ball_a", "ball_b"}) {
      Model ball;
      ball.name = name;
      ball.shape.kind = ShapeKind::kSphere;
      ball.shape.radius = 0.5;
      ball.density = 500;
      ball.pose.position = {name[5] == 'a' ? 1.0 : 3.0, 2, 2};
      scene.models.push_back(ball);
    }
    auto made = make_bodies(scene);
    ASSERT_TRUE(made) << made.error().text();
    bodies = std::move(*made);
    body_rows.columns = output::body_columns(scene);
    probe_rows.columns = {"gauge"};
    for (int i = 0; i <= 10; ++i) add_row(0.05 * i);
  }

  void add_row(double t) {
    std::vector<double> row(2 * output::kBodyValues, 0.0);
    for (std::size_t b = 0; b < 2; ++b) {
      double* body = &row[b * output::kBodyValues];
      body[0] = b == 0 ? 1 : 3;
      body[1] = 2;
      body[2] = 2 + (b == 0 ? t * t : 0);  // 2 m/s^2 upwards
      body[3] = 1;
      body[9] = b == 0 ? 2 * t : 0;
    }
    ASSERT_TRUE(body_rows.add(t, row));
    probe_rows.add(t, std::vector<double>{std::sin(t)});
  }

  Verdict judged(const Expect& expect) {
    return judge_one(expect, {scene, bodies, body_rows, probe_rows, fluid, rigid, imbalance, references});
  }
};

Expect of_kind(ExpectKind kind, const std::string& models = "") {
  Expect e;
  e.kind = kind;
  e.models = models;
  return e;
}

TEST_F(Fixture, LostParticlesMustBeNone) {
  EXPECT_TRUE(judged(of_kind(ExpectKind::kLostParticles)).pass);
  fluid["particles"]["lost"] = 1;
  EXPECT_FALSE(judged(of_kind(ExpectKind::kLostParticles)).pass);
  fluid["particles"].erase("lost");  // unknown is not none
  EXPECT_FALSE(judged(of_kind(ExpectKind::kLostParticles)).pass);
}

TEST_F(Fixture, LostParticlesMayBeAShareOfThoseAtTheStart) {
  Expect e = of_kind(ExpectKind::kLostParticles);
  e.within_relative = 0.25;
  fluid["particles"] = {{"fluid", 180}, {"left_domain", 20}, {"misplaced", 30}, {"lost", 50}};
  EXPECT_TRUE(judged(e).pass);
  fluid["particles"]["lost"] = 51;
  EXPECT_FALSE(judged(e).pass);
}

TEST_F(Fixture, ALossThatTheSceneDoesNotSpeakOfIsAMissAboveOnePercent) {
  const auto loss = [&] {
    return judge_unforeseen_loss({scene, bodies, body_rows, probe_rows, fluid, rigid, imbalance, references});
  };
  EXPECT_FALSE(loss());
  fluid["particles"] = {{"fluid", 190}, {"left_domain", 10}, {"misplaced", 0}, {"lost", 2}};
  EXPECT_FALSE(loss()) << "1 % of 200";
  fluid["particles"]["lost"] = 3;
  ASSERT_TRUE(loss());
  EXPECT_FALSE(loss()->pass);
  EXPECT_NE(loss()->note.find("lost_particles: 5 %"), std::string::npos) << loss()->note;
  scene.expects.push_back(of_kind(ExpectKind::kMomentum));
  EXPECT_TRUE(loss());
  scene.expects.push_back(of_kind(ExpectKind::kLostParticles));
  EXPECT_FALSE(loss()) << "that one judges it";
}

TEST_F(Fixture, AFluidProcessThatDiedHasNotLostNothing) {
  fluid = nlohmann::json::object();
  EXPECT_FALSE(judged(of_kind(ExpectKind::kLostParticles)).pass);
  Expect inside = of_kind(ExpectKind::kInside, "ball_*");
  inside.container = "tank";
  EXPECT_FALSE(judged(inside).pass);
  scene.fluids.clear();
  EXPECT_TRUE(judged(of_kind(ExpectKind::kLostParticles)).pass);
  EXPECT_TRUE(judged(inside).pass);
}

TEST_F(Fixture, MovedCountsModelsByPattern) {
  Expect e = of_kind(ExpectKind::kMoved, "ball_*");
  e.by = 0.24;  // ball_a moves 0.25 m
  e.at_least = 1;
  EXPECT_TRUE(judged(e).pass);
  e.at_least = 2;
  EXPECT_FALSE(judged(e).pass);
  EXPECT_EQ(judged(e).value, 1);
  e.at_least = 1;
  e.by = 0.26;
  EXPECT_FALSE(judged(e).pass);
}

TEST_F(Fixture, InsideSeesABodyThatWasOutsideOnlyOnce) {
  Expect e = of_kind(ExpectKind::kInside, "ball_*");
  e.container = "tank";
  EXPECT_TRUE(judged(e).pass) << judged(e).note;
  body_rows.values[5 * body_rows.columns.size()] = -0.1;  // ball_a.x in row 5: in the tank's wall
  const Verdict missed = judged(e);
  EXPECT_FALSE(missed.pass);
  EXPECT_EQ(missed.value, 1);
  EXPECT_NE(missed.note.find("ball_a"), std::string::npos);
}

TEST_F(Fixture, InsideCountsParticles) {
  Expect e = of_kind(ExpectKind::kInside, "ball_*");
  e.container = "tank";
  fluid["particles"]["outside"] = 3;
  EXPECT_EQ(judged(e).value, 3);
  EXPECT_FALSE(judged(e).pass);
}

TEST_F(Fixture, ColumnIsComparedWithToleranceAndBounds) {
  Expect e = of_kind(ExpectKind::kColumn);
  e.column = "ball_a.z";
  e.equals = 2.26;  // it is 2.25
  e.within = 0.011;
  EXPECT_TRUE(judged(e).pass);
  e.within = 0.009;
  EXPECT_FALSE(judged(e).pass);
  e.within.reset();
  e.within_relative = 0.01;
  EXPECT_TRUE(judged(e).pass);
  e.equals.reset();
  e.below = 2.2;
  EXPECT_FALSE(judged(e).pass);
  e.below.reset();
  e.above = 2.2;
  EXPECT_TRUE(judged(e).pass);
}

TEST_F(Fixture, ColumnThatIsNotThereOrNotFiniteIsMissed) {
  Expect e = of_kind(ExpectKind::kColumn);
  e.column = "ball_c.z";
  e.above = -1e9;
  EXPECT_FALSE(judged(e).pass);
  e.column = "gauge";
  EXPECT_TRUE(judged(e).pass);
  probe_rows.values.back() = NAN;
  EXPECT_FALSE(judged(e).pass);
}

TEST_F(Fixture, InitialAccelerationFollowsAddedMassFormula) {
  // r = 1/2: upward acceleration g (1 - r) / (r + C) = 2 for C = g/4 - 1/2.
  Expect e = of_kind(ExpectKind::kInitialAcceleration, "ball_a");
  e.coefficient = 9.81 / 4 - 0.5;
  e.within_relative = 1e-6;
  e.to = 0.2;
  const Verdict met = judged(e);
  EXPECT_TRUE(met.pass) << met.value << " " << met.bound_text();
  EXPECT_NEAR(met.value, -2, 1e-9);  // against gravity
  e.coefficient = 0.5;
  EXPECT_FALSE(judged(e).pass);
}

TEST_F(Fixture, JitterIsTheLargestChangeOfAccelerationInTheWindow) {
  Expect e = of_kind(ExpectKind::kJitter, "ball_*");
  e.below = 0.5;
  EXPECT_TRUE(judged(e).pass);                                 // no acceleration anywhere
  body_rows.values[3 * body_rows.columns.size() + 15] = 9.81;  // ball_a.az at 0.15 s
  EXPECT_FALSE(judged(e).pass);
  EXPECT_NEAR(judged(e).value, 1, 1e-12);
  e.from = 0.2;
  EXPECT_TRUE(judged(e).pass);
  e.from = 0.5;  // one row has no change
  EXPECT_FALSE(judged(e).pass);
}

TEST_F(Fixture, MomentumNeedsBothReports) {
  EXPECT_FALSE(judged(of_kind(ExpectKind::kMomentum)).pass);
  imbalance = 1e-13;
  EXPECT_TRUE(judged(of_kind(ExpectKind::kMomentum)).pass);
  imbalance = 1e-3;
  EXPECT_FALSE(judged(of_kind(ExpectKind::kMomentum)).pass);
}

TEST_F(Fixture, TotalMomentumAddsFluidAndBodies) {
  const Expect e = [] {
    Expect one = of_kind(ExpectKind::kTotalMomentum);
    one.below = 1e-5;
    return one;
  }();
  EXPECT_FALSE(judged(e).pass);  // no ledger
  fluid["ledger"] = {{"momentum_start", {3, 0, 0}}, {"momentum_end", {3, 0, 0}}};
  const std::size_t width = body_rows.columns.size(), last = (body_rows.rows() - 1) * width;
  for (std::size_t k = 0; k < width; ++k)  // all velocities stay those of the first row
    if (k % output::kBodyValues >= 7 && k % output::kBodyValues <= 9) body_rows.values[last + k] = body_rows.values[k];
  EXPECT_TRUE(judged(e).pass);
  body_rows.values[last + 7] += 0.5;  // ball_a.vx
  EXPECT_FALSE(judged(e).pass);
  fluid["ledger"]["momentum_end"][0] = 3 - 0.5 * bodies[1].mass;
  EXPECT_TRUE(judged(e).pass);
}

TEST_F(Fixture, TrackMeasuresRmsAgainstTheReferenceAtItsTimes) {
  const auto folder = std::filesystem::temp_directory_path() / ("ballast_track_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "sine.csv") << "# exact\nt,eta\n0.1,1.0998\n0.2,1.1987\n0.4,1.3894\n9,5\n";
  Expect e = of_kind(ExpectKind::kTrack);
  e.column = "gauge";
  e.reference = "sine.csv";
  e.value_offset = -1;  // reference = simulated + 1
  e.within = 1e-4;
  references = {folder.string()};
  const Verdict met = judged(e);
  EXPECT_TRUE(met.pass) << met.value << " " << met.note;
  e.value_offset = -1.01;
  const Verdict missed = judged(e);
  EXPECT_FALSE(missed.pass);
  EXPECT_NEAR(missed.value, 0.01, 1e-4);
  std::filesystem::remove_all(folder);
}

TEST_F(Fixture, TrackWithoutItsReferenceIsNeitherPassedNorMissed) {
  Expect e = of_kind(ExpectKind::kTrack);
  e.column = "gauge";
  e.reference = "nowhere.csv";
  e.within = 1;
  const Verdict verdict = judged(e);
  EXPECT_FALSE(verdict.pass);
  EXPECT_TRUE(verdict.reference_missing);
  EXPECT_TRUE(verdict.json()["pass"].is_null());
}

TEST(Matches, StarStandsForAnything) {
  EXPECT_TRUE(matches("crate*", "crate_0_1_2"));
  EXPECT_TRUE(matches("crate_*_2", "crate_0_2"));
  EXPECT_FALSE(matches("crate*", "tank"));
  EXPECT_FALSE(matches("crate", "crate_0"));
}

}  // namespace
}  // namespace ballast::launch
