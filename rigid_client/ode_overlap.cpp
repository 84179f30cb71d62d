// Contacts between posed shapes, deeper than what touches.
#include "rigid_client/ode_overlap.h"

#include "rigid_client/ode_shapes.h"

namespace ballast::rigid {

namespace {

constexpr double kTouching = 1e-3;  // of length_scale: ten times as deep as resting contacts lie

}  // namespace

struct Overlap::Shapes {
  BodySet bodies;
  OdeShapes shapes;
  std::vector<ContactPoint> contacts;
};

Result<std::unique_ptr<Overlap>> Overlap::make(const exchange::ManifestView& manifest) {
  auto shapes = std::make_unique<Shapes>();
  if (auto fine = shapes->bodies.load(manifest); !fine) return fine.error();
  if (auto fine = shapes->shapes.load(manifest); !fine) return fine.error();
  return std::unique_ptr<Overlap>(new Overlap(std::move(shapes)));
}

Overlap::Overlap(std::unique_ptr<Shapes> shapes) : shapes_(std::move(shapes)) {}
Overlap::~Overlap() = default;

std::optional<Overlap::Found> Overlap::deepest(std::size_t body, std::span<const exchange::BodyState> states) {
  BodySet& bodies = shapes_->bodies;
  for (std::size_t b = 0; b < states.size(); ++b) {
    const exchange::BodyState& s = states[b];
    bodies.now[b].position = Vec3(s.position[0], s.position[1], s.position[2]);
    bodies.now[b].orientation = Quat(s.orientation[0], s.orientation[1], s.orientation[2], s.orientation[3]);
  }
  shapes_->shapes.collide(bodies, shapes_->contacts);
  std::optional<Found> found;
  for (const ContactPoint& c : shapes_->contacts) {
    if (c.body != body && c.other != body) continue;
    if (c.depth <= kTouching * bodies.world.length_scale || (found && c.depth <= found->depth)) continue;
    found = Found{c.body == body ? c.other : c.body, c.depth};
  }
  return found;
}

}  // namespace ballast::rigid
