// Pictures: the scene file holds what is in the scene, and povray makes a picture of the right size of it.
#include "common/output/picture.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/output/povray.h"

namespace ballast::output {
namespace {

/// True as soon as `holds` does, within ten seconds.
template <class Condition>
bool soon(Condition&& holds) {
  for (int tries = 0; tries < 1000; ++tries) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Letter of its state in /proc, Z for one that has ended and that nobody has waited for; 0 if there is none.
char state_of(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string number, name;
  char letter = 0;
  stat >> number >> name >> letter;
  return letter;
}

struct Picture : ::testing::Test {
  std::string folder =
      (std::filesystem::temp_directory_path() / ("ballast_picture_" + std::to_string(getpid()))).string();
  Scene scene;
  std::vector<Body> bodies;
  std::vector<Pose> poses;
  std::vector<float> positions = {0.1F, 0.1F, 0.1F, 0.2F, 0.1F, 0.1F}, velocities = {0, 0, 0, 3, 0, 0};

  void SetUp() override {
    std::filesystem::create_directories(folder);
    scene.world.spacing = 0.1;
    Model tank, crate;
    tank.name = "tank";
    tank.motion = Motion::kStatic;
    tank.shape.kind = ShapeKind::kOpenBox;
    tank.shape.size = {1, 1, 1};
    crate.name = "crate";
    crate.shape.size = {0.2, 0.2, 0.2};
    crate.density = 500;
    crate.pose.position = {0.5, 0.5, 0.7};
    scene.models = {tank, crate};
    auto made = make_bodies(scene);
    ASSERT_TRUE(made) << made.error().text();
    bodies = std::move(*made);
    for (const Body& body : bodies) poses.push_back(body.pose);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }
};

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

TEST_F(Picture, SceneFileHasASphereForEveryFiniteParticle) {
  positions.insert(positions.end(), {NAN, 0, 0});
  velocities.insert(velocities.end(), {0, 0, 0});
  ASSERT_TRUE(write_pov(folder + "/a.pov", scene, bodies, poses, {positions, velocities, {}, {}}));
  std::ifstream file(folder + "/a.pov");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(count(text, "texture {W"), 2u);
  EXPECT_EQ(count(text, "nan"), 0u);
}

TEST_F(Picture, IsA1280By720PngInTwoAndThreeDimensions) {
  for (int dimension : {2, 3}) {
    scene.world.dimension = dimension;
    const Status made = make_picture(folder, scene, bodies, poses, {positions, velocities, {}, {}}, 1);
    ASSERT_TRUE(made) << made.error().text();
    std::ifstream file(folder + "/picture.png", std::ios::binary);
    unsigned char head[24] = {};
    file.read(reinterpret_cast<char*>(head), sizeof head);
    EXPECT_EQ(std::string(reinterpret_cast<char*>(head) + 1, 3), "PNG");
    EXPECT_EQ(head[18] * 256 + head[19], 1280);
    EXPECT_EQ(head[22] * 256 + head[23], 720);
    std::filesystem::remove(folder + "/picture.png");
  }
}

TEST_F(Picture, WithoutPovraySaysWhatToInstall) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const Status status = make_picture(folder, scene, bodies, poses, {positions, velocities, {}, {}}, 1);
  setenv("PATH", path.c_str(), 1);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().cure.find("apt-get install povray"), std::string::npos);
}

// Killed while it draws, as by a second Ctrl-C: povray would go on for nobody, beside whatever comes next.
TEST_F(Picture, EndsWithWhoeverAskedForIt) {
  const std::string pid_file = folder + "/pid";
  std::ofstream(folder + "/povray") << "#!/bin/sh\necho $$ >" << pid_file << ".part\nmv " << pid_file << ".part "
                                    << pid_file << "\nexec sleep 60\n";
  std::filesystem::permissions(folder + "/povray", std::filesystem::perms::owner_all);
  const pid_t asking = fork();
  if (asking == 0) {
    setenv("PATH", (folder + ":" + std::getenv("PATH")).c_str(), 1);
    _exit(run_povray(folder + "/picture.pov", folder + "/picture.png", 1) ? 0 : 1);
  }
  ASSERT_TRUE(soon([&] { return std::filesystem::exists(pid_file); }));
  pid_t drawing = 0;
  std::ifstream(pid_file) >> drawing;
  EXPECT_EQ(kill(drawing, 0), 0);
  kill(asking, SIGKILL);
  waitpid(asking, nullptr, 0);
  EXPECT_TRUE(soon([&] { return state_of(drawing) == 0 || state_of(drawing) == 'Z'; }));
  if (drawing > 0) kill(drawing, SIGKILL);
}

}  // namespace
}  // namespace ballast::output
