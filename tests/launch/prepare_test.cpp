// What a scene needs, before anything runs.
#include "launch/prepare.h"

#include <gtest/gtest.h>

#include "common/scene/reader.h"

namespace ballast::launch {
namespace {

/// Whether contact sets are assembled for a crate in water with these two lines in its scene.
bool contact_sets(const std::string& coupling, const std::string& output) {
  const std::string text =
      "ballast: 1\nworld: { duration: 1 s, spacing: 5 cm }\n"
      "fluids: [{ name: water, material: water, fill: { box: { min: [0, 0, 0], max: [0.4, 0.4, 0.2] } } }]\n"
      "models:\n  - { name: tank, static: true, shape: { open_box: { inside: [0.4, 0.4, 0.6] } } }\n"
      "  - { name: crate, shape: { box: [0.2, 0.2, 0.2] }, density: 500, pose: [0.2, 0.2, 0.4] }\n" +
      coupling + "\n" + output + "\n";
  auto scene = read_scene_text(text, "crate");
  EXPECT_TRUE(scene);
  auto prepared = prepare(*std::move(scene), "crate");
  EXPECT_TRUE(prepared);
  return prepared->contact_sets;
}

TEST(Prepare, ContactSetsAreForWhoReadsThemOrAsksForThem) {
  EXPECT_FALSE(contact_sets("", ""));
  EXPECT_TRUE(contact_sets("", "output: { lcm: true }"));
  EXPECT_TRUE(contact_sets("coupling: { contact_sets: always }", ""));
  EXPECT_FALSE(contact_sets("coupling: { contact_sets: never }", "output: { lcm: true }"));
}

}  // namespace
}  // namespace ballast::launch
