// The table of what a run did without: counted by hand; what nobody can count stays null.
#include "launch/savings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ballast::launch {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

struct Savings : ::testing::Test {
  std::unique_ptr<Prepared> prepared;
  Outcome outcome;
  json rows;

  void look(const std::string& text) {
    auto scene = read_scene_text("ballast: 1\n" + text, "some.yaml");
    ASSERT_TRUE(scene) << scene.error().text();
    auto made = prepare(std::move(*scene), "some.yaml");
    ASSERT_TRUE(made) << made.error().text();
    prepared = std::make_unique<Prepared>(std::move(*made));
    auto collector = Collector::make(prepared->scene, prepared->fluid, prepared->rigid, ::testing::TempDir());
    ASSERT_TRUE(collector);
    rows = savings(*prepared, outcome, *collector);
  }
  json row(const std::string& what) const {
    for (const json& each : rows)
      if (each["what"] == what) return each;
    return nullptr;
  }
};

constexpr const char* kWater =
    "world: { duration: 1 s, spacing: 0.1 }\n"
    "fluids: [ { name: water, material: water, fill: { box: { min: [0, 0, 0], max: [1, 1, 1] } } } ]\n"
    "models: [ { name: tank, static: true, shape: { open_box: { inside: [1, 1, 2] } } } ]\n";

TEST_F(Savings, OfFieldsAreTheirBytesPerParticle) {
  outcome.fluid = {{"particles", {{"fluid", 1000}}}};
  look(kWater);
  EXPECT_EQ(row(kDensities)["saved_bytes"], 4000) << rows;
  EXPECT_EQ(row(kCompression)["saved_bytes"], 4000);
  EXPECT_TRUE(row(kViscous).is_null()) << "water has viscosity";
  EXPECT_FALSE(row(kFilms).is_null()) << "nothing moves freely";
  EXPECT_TRUE(row("picture.png")["saved_bytes"].is_null()) << "nobody can count a picture that was not drawn";
}

TEST_F(Savings, AreNotListedWhereNothingIsLeftOut) {
  look(
      "world: { duration: 1 s, spacing: 0.1 }\n"
      "fluids:\n"
      "  - { name: oil, density: 800, viscosity: 1, fill: { box: { min: [0, 0, 0], max: [1, 1, 1] } } }\n"
      "  - { name: water, density: 1000, fill: { box: { min: [0, 0, 1], max: [1, 1, 2] } } }\n"
      "models: [ { name: block, mass: 5, shape: { box: [0.5, 0.5, 0.5] }, pose: [3, 0, 0] } ]\n"
      "numerics: { pressure: implicit }\n");
  for (const char* what : {kViscous, kDensities, kCompression, kFilms, kFluidProcess, kRigidProcess, "steps asleep"})
    EXPECT_TRUE(row(what).is_null()) << what;
}

TEST_F(Savings, OfSleepAreWhatTheFluidMeasured) {
  outcome.fluid = {{"sleep",
                    {{"speed", 0.01},
                     {"after", 0.5},
                     {"asleep_s", 4.0},
                     {"steps", 200},
                     {"bound_m", 0.02},
                     {"drift_m", 0.01},
                     {"saved_s", 7.5},
                     {"watched_s", 0.002},
                     {"naps", json::array({{{"from", 1}, {"to", 5}, {"speed", 0.005}}})}}}};
  look(kWater);
  EXPECT_EQ(row("steps asleep")["saved_s"], 7.5);
  EXPECT_THAT(row("steps asleep")["difference"].get<std::string>(), HasSubstr("0.02 m"));
  EXPECT_THAT(row("steps asleep")["saved"].get<std::string>(), HasSubstr("looking for rest took 0.002 s"));
  const json record{{"left_out", rows}, {"sleep", outcome.fluid["sleep"]}};
  EXPECT_THAT(savings_lines(record), ::testing::Contains(HasSubstr("7.5 s")));
  EXPECT_THAT(sleep_line(record), HasSubstr("asleep for 4 s of simulated time, from t = 1 s"));
}

TEST_F(Savings, OfASleepThatNeverCameSayWhy) {
  outcome.fluid = {{"sleep",
                    {{"speed", 0.01},
                     {"after", 0.5},
                     {"asleep_s", 0.0},
                     {"steps", 0},
                     {"bound_m", 0.0},
                     {"drift_m", 0.0},
                     {"saved_s", 0.0},
                     {"watched_s", 0.003},
                     {"naps", json::array()},
                     {"awake_because", "the motor of joint 'winch' keeps the scene awake"}}}};
  look(kWater);
  EXPECT_THAT(row("steps asleep")["why"].get<std::string>(), HasSubstr("winch"));
  EXPECT_EQ(row("steps asleep")["saved"], "nothing; looking for rest took 0.003 s");
  EXPECT_THAT(sleep_line({{"sleep", outcome.fluid["sleep"]}}), HasSubstr("never asleep: the motor"));
}

}  // namespace
}  // namespace ballast::launch
