// Filling: fluids that touch leave nothing between them, fluids that overlap are refused.
#include "fluid_server/particles/fill.h"

#include <gtest/gtest.h>

#include "common/geometry/bodies.h"

namespace ballast::fluid {
namespace {

Fluid box(const char* name, double from, double to) {
  Fluid fluid;
  fluid.name = name;
  fluid.fill.kind = FillKind::kBox;
  fluid.fill.box = {{from, 0, 0}, {to, 0.5, 0.5}};
  return fluid;
}

Result<Filled> filled(const Scene& scene) {
  const Coordinates coordinates = Coordinates::make({{-1, -1, -1}, {2, 2, 2}}, {});
  auto bodies = make_bodies(scene);
  EXPECT_TRUE(bodies);
  return fill_fluids(scene, *bodies, coordinates, 0.145);
}

Scene two(double second_from) {
  Scene scene;
  scene.world.spacing = 0.05;
  scene.fluids = {box("left", 0, 0.5), box("right", second_from, 1)};
  return scene;
}

TEST(Fill, NoGhostStandsWhereAnotherFluidIs) {
  const Coordinates coordinates = Coordinates::make({{-1, -1, -1}, {2, 2, 2}}, {});
  const auto result = filled(two(0.5));
  ASSERT_TRUE(result) << result.error().text();
  EXPECT_EQ(result->particles.size(), 2000u);
  EXPECT_FALSE(result->ghosts.empty());
  for (const Record& g : result->ghosts) {
    const Vec3 p = coordinates.to_metres(g.x, g.y, g.z);
    EXPECT_FALSE((p.array() > 0.001).all() && p[0] < 0.999 && p[1] < 0.499 && p[2] < 0.499) << p.transpose();
  }
}

TEST(Fill, OverlappingFluidsAreRefusedByName) {
  const auto result = filled(two(0.2));
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().text().find("'right' overlaps"), std::string::npos) << result.error().text();
}

}  // namespace
}  // namespace ballast::fluid
