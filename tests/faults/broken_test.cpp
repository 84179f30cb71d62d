// Broken scenes through the real command: refused before anything starts, with exit code 2, the place and the cure.
#include <regex>
#include <set>

#include "tests/faults/broken_scenes.h"
#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

struct BrokenScenes : ::testing::Test {
  Scratch scratch;
  fs::path file = scratch.path / "broken.yaml";

  /// Runs it; what it said is in `said`.
  void refused(const std::vector<std::string>& arguments) {
    Command run(scratch.path, arguments);
    EXPECT_EQ(run.wait(), 2) << run.text();
    EXPECT_EQ(run.seen(), std::set<std::string>{}) << "a process was started for it";
    EXPECT_FALSE(fs::exists(scratch.path / "out")) << "outputs of a run that never was";
    EXPECT_EQ(run.left_behind(), std::vector<std::string>{});
    said = run.text();
  }
  void says(const std::string& word) const { EXPECT_NE(said.find(word), std::string::npos) << said; }
  /// A second line that says what to do.
  void has_a_cure() const { EXPECT_TRUE(std::regex_search(said, std::regex("\n  [^ ]"))) << said; }
  std::string said;
};

TEST_F(BrokenScenes, TheWholeSceneIsFine) {
  std::ofstream(file) << kWholeScene;
  Command run(scratch.path, {file.string(), "--duration", "5ms", "--no-expect"});
  EXPECT_EQ(run.wait(), 0) << run.text();
}

TEST_F(BrokenScenes, AreRefusedWithPlaceAndCure) {
  fs::create_directory(scratch.path / "folder.obj");
  std::ofstream(scratch.path / "empty.obj") << "";
  std::ofstream(scratch.path / "open.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::set<std::string> names;
  for (const Break& b : kBreaks) {
    SCOPED_TRACE(b.name);
    EXPECT_TRUE(names.insert(b.name).second) << "a second break of this name";
    std::string text = kWholeScene;
    const std::size_t at = text.find(b.text);
    ASSERT_NE(at, std::string::npos) << "the scene has no '" << b.text << "'";
    text.replace(at, std::string(b.text).size(), b.instead);
    const std::size_t in_it = std::string(b.instead).find('^'), mark = in_it == std::string::npos ? in_it : at + in_it;
    std::string place;
    if (mark != std::string::npos) {
      text.erase(mark, 1);
      const std::string before = text.substr(0, mark);
      place = std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ":" +
              std::to_string(mark - (before.find_last_of('\n') + 1) + 1) + ":";
    }
    std::ofstream(file) << text;
    refused({file.string()});
    EXPECT_TRUE(std::regex_search(said, std::regex("broken\\.yaml:[0-9]+:[0-9]+: "))) << said;
    says("broken.yaml:" + place);
    says(b.word);
    has_a_cure();
  }
  EXPECT_GE(names.size(), 80u);
}

struct Text {
  const char* name;
  std::string text;
  const char* word;
};

TEST_F(BrokenScenes, ThatAreNoScenesAtAllAreRefused) {
  std::string laughs = "a: &a [x, x, x, x, x, x, x, x]\n";
  for (char c = 'b'; c < 'k'; ++c) {
    laughs += std::string(1, c) + ": &" + c + " [";
    for (int i = 0; i < 8; ++i) laughs += std::string(i ? ", *" : "*") + static_cast<char>(c - 1);
    laughs += "]\n";
  }
  const std::vector<Text> texts = {
      {"Empty", "", "Start it with 'ballast: 1'"},
      {"Blank", "\n\n  \n# a comment\n", "Start it with 'ballast: 1'"},
      {"AWord", "hello", "not one"},
      {"AList", "- 1\n- 2\n", "not one"},
      {"OpenBracket", "ballast: 1\nworld: { duration: 1 s\nmodels: []\n", "YAML syntax"},
      {"OpenQuote", "ballast: 1\ndescription: \"never ends\n", ""},
      {"Tab", "ballast: 1\nworld:\n\tduration: 1 s\n", "YAML syntax"},
      {"TwoDocuments", "ballast: 1\n---\nballast: 1\n", "second document"},
      {"Binary",
       std::string("\x7f"
                   "ELF\x02\x01\x01\0\0\0\0\0\0\0\0\0\x03\0\x3e\0\xff\xfe\x80",
                   23),
       ""},
      {"Zeros", std::string(5000, '\0'), ""},
      {"Utf16",
       std::string("\xff\xfe"
                   "b\0a\0l\0l\0a\0s\0t\0",
                   16),
       ""},
      {"ALongLine", "ballast: 1\nworld: { duration: 1 s, spacing: " + std::string(10'000'000, '1') + " }\n", "spacing"},
      {"ALongName", "ballast: 1\nworld: { " + std::string(10'000'000, 'x') + ": 1 }\n", "YAML syntax"},
      {"Deep", "ballast: 1\nworld: " + std::string(5000, '[') + std::string(5000, ']') + "\n", ""},
      {"Cycle", "ballast: 1\nworld: &w { domain: *w }\n", "without end"},
      {"Laughs", laughs, "without end"},
      {"UnknownAnchor", "ballast: 1\nworld: *nobody\n", "YAML syntax"},
      {"NothingInIt", "ballast: 1\nworld: { duration: 1 s, spacing: 0.1 }\n", "neither fluids nor models"},
      {"NothingMoves",
       "ballast: 1\nworld: { duration: 1 s }\nmodels:\n  - { name: rock, static: true, shape: { box: [1, 1, 1] } }\n",
       "nothing to simulate"},
      {"StepsWithoutEnd",
       "ballast: 1\nworld: { duration: 1e9 s }\nmodels:\n  - { name: rod, shape: { box: [1, 1, 1] }, mass: 1 }\n"
       "coupling: { rigid_step: 1e-9 s }\n",
       "rigid_step"}};
  for (const Text& t : texts) {
    SCOPED_TRACE(t.name);
    std::ofstream(file, std::ios::binary) << t.text;
    refused({file.string()});
    says("broken.yaml");
    says(t.word);
    has_a_cure();
    EXPECT_LT(said.size(), 5000u) << "a message that nobody reads";
  }
}

TEST_F(BrokenScenes, ThatAreNotFilesAreRefused) {
  refused({scratch.path.string()});
  says("cannot be read");
  has_a_cure();
  refused({(scratch.path / "nowhere.yaml").string()});
  says("there is no scene file");
  has_a_cure();
  refused({"pendulam"});
  says("Did you mean 'pendulum'?");
}

TEST_F(BrokenScenes, BrokenOnTheCommandLineAreRefusedByItsName) {
  std::ofstream(file) << kWholeScene;
  const std::vector<std::pair<std::vector<std::string>, const char*>> lines = {
      {{"--duration", "0.2s"}, "the window begins at 0.5 s, after the end of the run"},
      {{"--duration", "-1s"}, "--set world.duration"},
      {{"--spacing", "50m"}, "less than a particle"},
      {{"--spacing", "1e-7"}, "particles"},
      {{"--spacing", "5 s"}, "--set world.spacing"},
      {{"--engine", "bullet"}, "--set coupling.engine"},
      {{"--scheme", "parallel"}, "--set coupling.scheme"},
      {{"--set", "models.bux.mass=3"}, "Did you mean 'box'"},
      {{"--set", "models.box.density=1e300"}, "is the unit right?"},
      {{"--set", "wurld.spacing=1"}, "Did you mean 'world'"},
      {{"--set", "world.spacing"}, "PATH=VALUE"},
      {{"--threads", "1000000000"}, "--threads"},
      {{"--threads", "1024"}, "--threads"},
      {{"--threads", "0"}, "--threads"},
      {{"--threads", "two"}, "--threads"},
      {{"--references", "/nowhere"}, "/nowhere"},
      {{"--timeout", "0"}, "--timeout"},
      {{"--timeout", "2 kg"}, "'2 kg' is a mass (kg), but a time (s) is needed"},
      {{"--replay", "nowhere.json"}, "nowhere.json"},
      {{"--lcm-url", "pigeon"}, "'pigeon' is no LCM URL"},
      {{"--pictur"}, "Did you mean '--picture'"}};
  for (auto [arguments, word] : lines) {
    SCOPED_TRACE(arguments.front() + " " + arguments.back());
    arguments.insert(arguments.begin(), file.string());
    refused(arguments);
    says(word);
  }
}

/// The looks at a scene take what the run takes, and see what it would see.
TEST_F(BrokenScenes, AreSeenByCheckToo) {
  std::string text = kWholeScene;
  text.replace(text.find("max: [1, 1, 0.5]"), 16, "max: [2, 1, 0.5]");
  std::ofstream(file) << text;
  const fs::path log = scratch.path / "said";
  const auto call = [&](const std::string& line) {
    const std::string command =
        std::string(BALLAST_BIN_DIR) + "/ballast_coordinator " + line + " >" + log.string() + " 2>&1";
    const int status = std::system(command.c_str());
    said = text_of(log);
    return WEXITSTATUS(status);
  };
  EXPECT_EQ(call("check " + file.string()), 0) << said;
  // a metre of two beside the tank of one, its wall of 15 cm and the two bodies not counted
  says("% of the fluid 'water' starts outside every container");
  EXPECT_EQ(call("check " + file.string() + " --duration 0.2s"), 2) << said;
  EXPECT_EQ(call("plan " + file.string() + " --spacing 50m"), 2) << said;
  EXPECT_EQ(call("resolve " + file.string() + " --engine free_body --duration 4s"), 0) << said;
  says("free_body");
  says("duration: 4");
  EXPECT_EQ(call("check " + file.string() + " --engine free_body"), 2) << said;
  says("engine free_body has no joints, but joint 'pin'");
  EXPECT_EQ(call("tell paus"), 2) << said;
  says("tell has no action 'paus'\n  Did you mean 'pause'?");
}

}  // namespace
}  // namespace ballast::testing
