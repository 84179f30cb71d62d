// Commands that act: what the scene alone shows to be wrong is refused with the reason; records read back.
#include "launch/act.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

namespace ballast::launch {
namespace {

using ::testing::HasSubstr;

constexpr const char* kScene = R"(
ballast: 1
world: { duration: 1 s }
models:
  - { name: floor, static: true, shape: { plane: { normal: [0, 0, 1] } } }
  - { name: crate, shape: { box: [0.1, 0.1, 0.1] }, density: 500, pose: [0, 0, 1] }
  - { name: door, shape: { box: [0.1, 0.1, 0.1] }, density: 500, pose: [1, 0, 1] }
  - { name: piston, prescribed: { velocity: [0, 0, 1] }, shape: { box: [0.1, 0.1, 0.1] }, pose: [2, 0, 1] }
joints:
  - { name: hinge, type: revolute, parent: world, child: door, anchor: [1, 0, 1], axis: [0, 0, 1] }
)";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Prepared prepared(const std::string& text = kScene) {
  auto scene = read_scene_text(text, "test.yaml");
  EXPECT_TRUE(scene) << scene.error().text();
  auto out = prepare(*std::move(scene), "test.yaml");
  EXPECT_TRUE(out) << out.error().text();
  return *std::move(out);
}

RunCommand push(const std::string& body) {
  RunCommand c;
  c.action = "wrench", c.body = body, c.force = {1, 2, 3}, c.torque = {4, 5, 6}, c.duration = 0.5;
  return c;
}
RunCommand put(const std::string& body) {
  RunCommand c;
  c.action = "pose", c.body = body, c.position = {1, 2, 3}, c.orientation = {0.6, 0, 0.8, 0};
  return c;
}
RunCommand pull(double z) {
  RunCommand c;
  c.action = "gravity", c.gravity = {0, 0, z};
  return c;
}

TEST(Act, RefusesWhatWouldTearEverythingApart) {
  const Prepared p = prepared();
  RunCommand c = push("crate");  // 0.5 kg
  c.force = {0, 0, 4.9e5};
  EXPECT_TRUE(to_exchange(c, p));
  c.force = {0, 0, 5.1e5};
  auto refused = to_exchange(c, p);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("1.02e+06 m/s^2, more than 1e+06"));
  c.force = {0, 0, 0}, c.torque = {0, 900, 0};  // inertia 0.5 kg (0.1 m)^2 / 6
  refused = to_exchange(c, p);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("1.08e+06 rad/s^2"));
  c.torque = {0, 0, 0};
  refused = to_exchange(c, p);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("neither a force nor a torque"));
  EXPECT_TRUE(to_exchange(pull(-1e6), p));
  refused = to_exchange(pull(-1e40), p);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("1e+40 m/s^2 is more than 1e+06"));
}

TEST(Act, ReplaysOnlyTheSameMotion) {
  const Scene scene = prepared().scene;
  Replay replay;
  replay.motion_hash = motion_hash(scene);
  Scene watched = scene;
  watched.output.lcm = watched.output.vtk = true;
  EXPECT_TRUE(same_motion(replay, watched));
  Scene heavier = scene;
  heavier.world.gravity *= 2;
  EXPECT_FALSE(same_motion(replay, heavier));
  EXPECT_TRUE(same_motion({}, scene));  // commands written by hand
}

TEST(Act, MakesRecordsOfCommands) {
  const Prepared p = prepared();
  const auto wrench = to_exchange(push("crate"), p);
  ASSERT_TRUE(wrench) << wrench.error().text();
  EXPECT_EQ(wrench->kind, exchange::CommandKind::kWrench);
  EXPECT_EQ(wrench->body, 1u);
  EXPECT_THAT(wrench->values, ::testing::ElementsAre(1, 2, 3, 4, 5, 6, 0));
  EXPECT_EQ(wrench->duration, 0.5);
  const auto pose = to_exchange(put("crate"), p);
  ASSERT_TRUE(pose) << pose.error().text();
  EXPECT_THAT(pose->values, ::testing::ElementsAre(1, 2, 3, 0.6, 0, 0.8, 0));
  const auto gravity = to_exchange(pull(-1.62), p);
  ASSERT_TRUE(gravity) << gravity.error().text();
  EXPECT_THAT(gravity->values, ::testing::ElementsAre(0, 0, -1.62, 0, 0, 0, 0));
}

TEST(Act, RefusesWhatTheSceneShowsToBeWrong) {
  const Prepared p = prepared();
  const auto why = [&](const RunCommand& c) {
    const auto made = to_exchange(c, p);
    return made ? "it was taken" : made.error().what;
  };
  EXPECT_THAT(why(push("crat")), HasSubstr("Did you mean 'crate'"));
  EXPECT_THAT(why(push("floor")), HasSubstr("'floor' is static"));
  EXPECT_THAT(why(put("piston")), HasSubstr("'piston' is prescribed"));
  EXPECT_THAT(why(put("door")), HasSubstr("joint 'hinge'"));
  EXPECT_THAT(why(push("door")), HasSubstr("it was taken"));
  RunCommand c = push("crate");
  c.force[1] = kNan;
  EXPECT_THAT(why(c), HasSubstr("the force has nan"));
  c = push("crate");
  c.torque[2] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(why(c), HasSubstr("the torque has inf"));
  for (const double duration : {0.0, -1.0, kNan}) {
    c = push("crate");
    c.duration = duration;
    EXPECT_THAT(why(c), HasSubstr("duration")) << duration;
  }
  c = put("crate");
  c.orientation = {0, 0, 0, 0};
  EXPECT_THAT(why(c), HasSubstr("length 0"));
  c = put("crate");
  c.position[0] = 1e9;
  EXPECT_THAT(why(c), HasSubstr("farther away"));
  EXPECT_THAT(why(pull(kNan)), HasSubstr("the gravity has nan"));
}

TEST(Act, KeepsToThePlaneInDimension2) {
  std::string text = kScene;
  text.replace(text.find("joints:"), std::string::npos, "");
  text.replace(text.find("world: {"), 8, "world: { dimension: 2,");
  const Prepared p = prepared(text);
  EXPECT_THAT(to_exchange(push("crate"), p).error().what, HasSubstr("along y"));
  RunCommand c = push("crate");
  c.force[1] = 0;
  EXPECT_THAT(to_exchange(c, p).error().what, HasSubstr("turn about y"));
  c.torque = {0, 5, 0};
  EXPECT_TRUE(to_exchange(c, p));
}

struct Replays : ::testing::Test {
  // Of this process alone: ctest runs these tests side by side.
  const std::string path = ::testing::TempDir() + "/ballast_act_record_" + std::to_string(getpid()) + ".json";
  ~Replays() override { std::filesystem::remove(path); }
};

TEST_F(Replays, HaveTheCommandsThatTookEffectAndTheEnd) {
  nlohmann::json commands = nlohmann::json::array({{{"action", "pause"}, {"step", 3}}});
  for (const RunCommand& c : {push("crate"), put("crate"), pull(-2)}) commands.push_back(to_json(c));
  commands[1]["step"] = 7, commands[2]["step"] = 9, commands[3]["step"] = 9;
  commands[2]["refused"] = "something is there";
  commands.push_back(to_json(push("door")));  // the run ended before it took effect
  std::ofstream(path) << nlohmann::json{{"commands", commands}, {"stopped_after_step", 17}};
  const auto replay = read_replay(path);
  ASSERT_TRUE(replay) << replay.error().text();
  EXPECT_EQ(replay->stop_after, 17u);
  ASSERT_EQ(replay->commands.size(), 2u);
  EXPECT_EQ(replay->commands[0].step, 7u);
  EXPECT_EQ(to_json(replay->commands[0].command), to_json(push("crate")));
  EXPECT_EQ(replay->commands[1].step, 9u);
  EXPECT_EQ(to_json(replay->commands[1].command), to_json(pull(-2)));
}

TEST_F(Replays, OfRunsWithoutCommandsOrOfNoRecordAreErrorsThatSayWhy) {
  std::ofstream(path) << R"({"steps": 17})";
  EXPECT_THAT(read_replay(path).error().what, HasSubstr("no record of a run that a command"));
  std::ofstream(path) << R"({"commands": [{"action": "gravity", "step": 5, "gravity_m_s2": "down"}]})";
  EXPECT_THAT(read_replay(path).error().what, HasSubstr("cannot read the command"));
  for (const char* odd : {R"({"commands": {"action": "gravity"}})", R"({"commands": [5]})",
                          R"({"commands": [{"action": 5}]})", R"({"stopped_after_step": "soon"})"}) {
    std::ofstream(path) << odd;
    EXPECT_THAT(read_replay(path).error().what, HasSubstr("in a form that no record has")) << odd;
  }
  EXPECT_THAT(read_replay("no such file").error().what, HasSubstr("cannot read"));
}

}  // namespace
}  // namespace ballast::launch
