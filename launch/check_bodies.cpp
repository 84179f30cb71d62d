// Bodies that a scene hardly means: where no fluid ever comes, or smaller than what the fluid is made of.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "launch/prepare.h"

namespace ballast::launch {

namespace {

/// Centre, in the world, and radius of a ball around the body; nothing for planes.
struct Ball {
  Vec3 centre;
  double radius;
};
std::optional<Ball> ball_around(const Body& body, int dimension) {
  Box3 box = body.solid.bounds();
  if (dimension == 2) box.min.y() = box.max.y() = 0;
  if (!((box.max - box.min).norm() < 1e100)) return std::nullopt;
  return Ball{body.pose.position + body.pose.rotation * Vec3(0.5 * (box.min + box.max)),
              0.5 * (box.max - box.min).norm()};
}

bool beyond_domain(const World& world, const Ball& ball) {
  if (!world.domain) return false;
  for (int k = 0; k < 3; ++k) {
    if ((world.dimension == 2 && k == 1) || world.periodic[static_cast<std::size_t>(k)]) continue;
    if (ball.centre[k] + ball.radius < world.domain->min[k] || ball.centre[k] - ball.radius > world.domain->max[k])
      return true;
  }
  return false;
}

/// The container that it is nearest to, if the scene has some and it lies in none of them; nullptr: it lies in one.
const Model* beyond_containers(const Prepared& p, std::size_t b, const Ball& ball) {
  const Model* nearest = nullptr;
  double least = 1e300;
  for (std::size_t c = 0; c < p.bodies.size(); ++c) {
    const Body& container = p.bodies[c];
    if (c == b || !container.solid.is_container() || p.scene.models[c].motion == Motion::kDynamic) continue;
    const double distance =
        container.solid.room_distance(container.pose.rotation.conjugate() * (ball.centre - container.pose.position));
    if (distance < ball.radius) return nullptr;
    if (distance < least) least = distance, nearest = &p.scene.models[c];
  }
  return nearest;
}

/// Smallest edge of the box around it in its own frame, m.
double thickness(const Body& body, int dimension) {
  Vec3 size = body.solid.bounds().max - body.solid.bounds().min;
  if (dimension == 2) size.y() = 1e300;
  return size.minCoeff();
}

/// What is odd about body b, and the cure; empty: nothing.
std::string oddity(const Prepared& p, std::size_t b) {
  const World& world = p.scene.world;
  const Model& model = p.scene.models[b];
  const auto ball = ball_around(p.bodies[b], world.dimension);
  if (!ball) return "";
  const Vec3& x = ball->centre;
  const bool free = model.motion == Motion::kDynamic;
  if (beyond_domain(world, *ball))
    return free ? fmt::format(
                      "is at ({:.3g}, {:.3g}, {:.3g}) m, wholly outside world.domain, where no fluid ever "
                      "comes: move it, or enlarge world.domain",
                      x.x(), x.y(), x.z())
                : "";
  if (const Model* nearest = beyond_containers(p, b, *ball))
    return free ? fmt::format(
                      "is at ({:.3g}, {:.3g}, {:.3g}) m, wholly outside every container, the nearest of which "
                      "is '{}': move it inside, or enlarge that",
                      x.x(), x.y(), x.z(), nearest->name)
                : "";
  if (const double size = thickness(p.bodies[b], world.dimension); size < world.spacing * (1 - 1e-9))
    return fmt::format(
        "is {:.3g} m thick, less than a particle of world.spacing, {:.3g} m: what the fluid does to it "
        "is not resolved; make it larger, or world.spacing smaller, {:.2g} m or less",
        size, world.spacing, size / 3);
  return "";
}

}  // namespace

std::vector<std::string> odd_bodies(const Prepared& prepared) {
  std::vector<std::string> out;
  if (prepared.scene.fluids.empty()) return out;
  const auto& models = prepared.scene.models;
  const auto same_place = [](const Place& a, const Place& b) { return a.line == b.line && a.column == b.column; };
  for (std::size_t b = 0; b < models.size();) {  // copies made by `repeat` lie one after another and share a place
    const std::size_t first = b;
    std::size_t odd = 0;
    std::string name, text;
    for (; b < models.size() && (b == first || same_place(models[b].place, models[first].place)); ++b) {
      std::string what = oddity(prepared, b);
      if (what.empty()) continue;
      if (odd++ == 0) name = models[b].name, text = std::move(what);
    }
    if (odd == 0) continue;
    const Place& place = models[first].place;
    out.push_back(fmt::format("{}:{}:{}: the body '{}'{} {}", place.file, place.line, place.column, name,
                              odd > 1 ? fmt::format(" (and {} more copies)", odd - 1) : "", text));
  }
  return out;
}

}  // namespace ballast::launch
