// What a scene needs, before anything runs.
#include "launch/prepare.h"

#include <gtest/gtest.h>

#include "common/scene/reader.h"

namespace ballast::launch {
namespace {

/// To whom the contact sets of a crate in water go, with these two lines in its scene.
struct Readers {
  bool engine, messages;
  bool operator==(const Readers&) const = default;
};
Readers readers(const std::string& coupling, const std::string& output) {
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
  return {prepared->contact_sets, prepared->contacts_shown};
}

TEST(Prepare, ContactSetsAreForWhoReadsThemOrAsksForThem) {
  const std::string always = "coupling: { contact_sets: always }", lcm = "output: { lcm: true }";
  EXPECT_EQ(readers("", ""), (Readers{false, false}));
  EXPECT_EQ(readers("", lcm), (Readers{false, true}));
  EXPECT_EQ(readers(always, ""), (Readers{true, false}));
  EXPECT_EQ(readers(always, lcm), (Readers{true, true}));
  EXPECT_EQ(readers("coupling: { contact_sets: never }", lcm), (Readers{false, false}));
}

TEST(Prepare, WhatTheFluidProcessSaysOfAFluidHasItsPlaceInTheFile) {
  Prepared prepared;
  prepared.scene.fluids.resize(2);
  prepared.scene.fluids[0].name = "oil", prepared.scene.fluids[1].name = "oil.b";
  prepared.scene.fluids[1].place = {"two.yaml", 7, 5};
  EXPECT_EQ(in_the_file(prepared, "fluids.oil.b: it overlaps\n  move it"), "two.yaml:7:5: it overlaps\n  move it");
  EXPECT_EQ(in_the_file(prepared, "fluids.water: what"), "fluids.water: what");
}

}  // namespace
}  // namespace ballast::launch
