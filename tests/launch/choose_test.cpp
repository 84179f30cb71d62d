// What `auto` becomes, and that it says why.
#include "launch/choose.h"

#include <gtest/gtest.h>

namespace ballast::launch {
namespace {

Scene crate_in_water() {
  Scene scene;
  scene.fluids.resize(1);
  scene.models.resize(2);
  scene.models[0].name = "tank";
  scene.models[0].motion = Motion::kStatic;
  scene.models[1].name = "crate";
  return scene;
}

TEST(Choose, WhatTheSceneSaysStays) {
  Scene scene = crate_in_water();
  scene.numerics.pressure = Pressure::kImplicit;
  scene.coupling.scheme = "staggered";
  const Choices choices = choose(scene);
  EXPECT_EQ(scene.numerics.pressure, Pressure::kImplicit);
  EXPECT_EQ(scene.coupling.scheme, "staggered");
  EXPECT_EQ(choices.pressure_reason + choices.scheme_reason, "");
}

TEST(Choose, AJointInWaterIsIteratedAndNamed) {
  Scene scene = crate_in_water();
  EXPECT_NE(choose(scene).scheme_reason, "");
  EXPECT_EQ(scene.coupling.scheme, "interlinked");
  scene.coupling.scheme = "auto";
  scene.joints.resize(1);
  Joint& joint = scene.joints[0];
  joint.name = "hinge", joint.kind = JointKind::kRevolute, joint.parent = "world", joint.child = "crate";
  EXPECT_NE(choose(scene).scheme_reason.find("'hinge'"), std::string::npos);
  EXPECT_EQ(scene.coupling.scheme, "iterated");
  scene.coupling.scheme = "auto";
  joint.kind = JointKind::kFixed;
  choose(scene);
  EXPECT_EQ(scene.coupling.scheme, "interlinked") << "held by the world";
}

TEST(Choose, WithoutFluidOrMotionThereIsNothingToChoose) {
  Scene dry = crate_in_water();
  dry.fluids.clear();
  EXPECT_EQ(choose(dry).scheme_reason, "");
  EXPECT_EQ(dry.coupling.scheme, "auto");
  Scene still = crate_in_water();
  still.models.pop_back();
  EXPECT_EQ(choose(still).scheme_reason, "");
}

TEST(Choose, TheSolverAndTheReasonFitTheScene) {
  Scene scene = crate_in_water();
  EXPECT_NE(choose(scene).pressure_reason.find("bodies move freely"), std::string::npos);
  EXPECT_EQ(scene.numerics.pressure, Pressure::kWcsph);
  Scene empty = crate_in_water();
  empty.models.pop_back();
  empty.world.accuracy = Accuracy::kInteractive;
  empty.world.spacing = 0.05;
  Scene flat = empty, weightless = empty, slow = empty, oil = empty;
  oil.fluids[0].viscosity = 100;
  EXPECT_NE(choose(empty).pressure_reason.find("nothing moves freely"), std::string::npos);
  EXPECT_EQ(empty.numerics.pressure, Pressure::kImplicit);
  flat.world.dimension = 2;
  weightless.world.gravity = Vec3::Zero();
  slow.numerics.courant = 0.3;  // which the implicit solver does not know
  for (Scene* other : {&flat, &weightless, &slow, &oil}) {
    EXPECT_NE(choose(*other).pressure_reason, "");
    EXPECT_EQ(other->numerics.pressure, Pressure::kWcsph);
  }
}

TEST(Choose, ParticlesAreShiftedWhereNoWeightPressesThemTogether) {
  Scene scene = crate_in_water();
  EXPECT_NE(choose(scene).shifting_reason, "");
  EXPECT_EQ(scene.numerics.shifting, When::kNever);
  Scene light = crate_in_water();
  light.world.gravity = Vec3::Zero();
  EXPECT_NE(choose(light).shifting_reason, "");
  EXPECT_EQ(light.numerics.shifting, When::kAlways);
  Scene reduced = crate_in_water();
  reduced.numerics.reduced_gravity = true;
  choose(reduced);
  EXPECT_EQ(reduced.numerics.shifting, When::kAlways);
  Scene open = crate_in_water(), closed = crate_in_water();
  open.numerics.pressure = closed.numerics.pressure = Pressure::kImplicit;
  open.world.gravity = Vec3::Zero();
  closed.numerics.reduced_gravity = true;
  choose(open), choose(closed);
  EXPECT_EQ(open.numerics.shifting, When::kNever);
  EXPECT_EQ(closed.numerics.shifting, When::kAlways);
  Scene said = crate_in_water();
  said.numerics.shifting = When::kAlways;
  EXPECT_EQ(choose(said).shifting_reason, "");
  EXPECT_EQ(said.numerics.shifting, When::kAlways);
}

}  // namespace
}  // namespace ballast::launch
