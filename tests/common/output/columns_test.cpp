// Names of columns against the documented layout.
#include "common/output/columns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace ballast::output {
namespace {

using ::testing::ElementsAre;

Model named(const std::string& name, Motion motion) {
  Model model;
  model.name = name;
  model.motion = motion;
  return model;
}

TEST(BodyColumns, LeaveOutStaticModelsAndKeepTheOrder) {
  Scene scene;
  scene.models = {named("tank", Motion::kStatic), named("gate", Motion::kPrescribed), named("crate", Motion::kDynamic)};
  EXPECT_THAT(moving_models(scene), ElementsAre(1, 2));
  const auto columns = body_columns(scene);
  ASSERT_EQ(columns.size(), 2u * kBodyValues);
  EXPECT_EQ(columns[0], "gate.x");
  EXPECT_EQ(columns[3], "gate.qw");
  EXPECT_EQ(columns[kBodyValues + 7], "crate.vx");
  EXPECT_EQ(columns[kBodyValues + 10], "crate.wx");
  EXPECT_EQ(columns[kBodyValues + 13], "crate.ax");
  EXPECT_EQ(columns[kBodyValues + 16], "crate.fx");
  EXPECT_EQ(columns[kBodyValues + 21], "crate.tz");
}

TEST(ProbeColumns, FollowTheKindOfProbe) {
  Scene scene;
  scene.probes.resize(4);
  scene.probes[0].name = "front";
  scene.probes[1].name = "push";
  scene.probes[1].kind = ProbeKind::kForce;
  scene.probes[2].name = "at";
  scene.probes[2].kind = ProbeKind::kPose;
  scene.probes[3].name = "all";
  scene.probes[3].kind = ProbeKind::kMotion;
  EXPECT_THAT(probe_columns(scene),
              ElementsAre("front", "push.fx", "push.fy", "push.fz", "push.tx", "push.ty", "push.tz", "at.x", "at.y",
                          "at.z", "at.qw", "at.qx", "at.qy", "at.qz", "all.px", "all.py", "all.pz", "all.lx", "all.ly",
                          "all.lz", "all.fastest"));
}

}  // namespace
}  // namespace ballast::output
