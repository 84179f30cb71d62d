// The end of a run that diverged.
#include "fluid_server/post_mortem.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace ballast::fluid {

namespace {

/// Particles in order of speed, not-a-number first; at most `most`.
std::vector<std::size_t> fastest(const Particles& particles, std::size_t most) {
  std::vector<std::size_t> order(particles.size());
  for (std::size_t f = 0; f < order.size(); ++f) order[f] = f;
  const auto speed = [&](std::size_t f) {
    const Record& r = particles.record[f];
    const double v = std::hypot(static_cast<double>(r.vx), r.vy, r.vz) + 0.0 * r.p;
    return std::isfinite(v) ? v : 1e300;
  };
  most = std::min(most, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end(), [&](auto a, auto b) {
    const double va = speed(a), vb = speed(b);
    return va != vb ? va > vb : particles.id[a] < particles.id[b];
  });
  order.resize(most);
  return order;
}

struct Nearest {
  std::size_t body = 0;
  double distance = 1e300;
};

Nearest nearest_body(const std::vector<Body>& bodies, std::span<const exchange::BodyState> states, const Vec3& point) {
  Nearest nearest;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Quat q = rotation_of(states[b]);
    const double distance = bodies[b].solid.distance(q.conjugate() * (point - Vec3::Map(states[b].position)));
    if (distance < nearest.distance) nearest = {b, distance};
  }
  return nearest;
}

}  // namespace

Error post_mortem(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid,
                  std::span<const exchange::BodyState> states, const LastStep& step) {
  const Particles& particles = fluid.particles();
  const double c = fluid.constants().sound_speed;
  Error error;
  error.exit_code = kDiverged;
  error.what =
      fmt::format("the fluid diverged at t = {:.6g} s (step {}, {:.3g} s long): ", step.time, step.number, step.dt);
  if (!fluid.facts().finite)
    error.what += "a velocity or pressure is not a number";
  else if (fluid.facts().max_speed > kMostMach * c)
    error.what += fmt::format("largest speed {:.3g} m/s, limit {:.3g} m/s ({} sound speeds)", fluid.facts().max_speed,
                              kMostMach * c, kMostMach);
  else if (step.energy_share > scene.numerics.energy_bound)
    error.what += fmt::format(
        "the fluid has gained {:.3g} J that nobody gave it, {:.3g} % of the energy at play, limit {:.2g} % "
        "(numerics.energy_bound)",
        step.energy_gain, 100 * step.energy_share, 100 * scene.numerics.energy_bound);
  else
    error.what +=
        fmt::format("mean density error {:.2g} %, limit {:.2g} %", 100 * step.compression_mean, 100 * kMostCompression);
  const auto worst = fastest(particles, 5);
  std::vector<std::string> causes;
  if (!worst.empty()) {
    const Record& r = particles.record[worst[0]];
    const Vec3 at = fluid.coordinates().to_metres(r.x, r.y, r.z);
    std::vector<std::uint32_t> ids;
    for (const std::size_t f : worst) ids.push_back(particles.id[f]);
    error.what += fmt::format("; particles {} first, around ({:.3g}, {:.3g}, {:.3g}) m", fmt::join(ids, ", "), at[0],
                              at[1], at[2]);
    const Nearest nearest = nearest_body(bodies, states, at);
    if (nearest.distance < 1e300) {
      const Model& model = scene.models[nearest.body];
      error.what += fmt::format(", {:.2g} m from '{}'", nearest.distance, model.name);
      const double volume = bodies[nearest.body].solid.mass_properties().volume;
      const double density = volume > 0 ? bodies[nearest.body].mass / volume : 0;
      if (fluid.scheme() == Scheme::kStaggered && model.motion == Motion::kDynamic &&
          density < fluid.filled().fluids[0].density)
        causes.push_back(
            fmt::format("coupling.scheme is staggered, which body '{}' of {:.3g} kg/m^3 is too light for: "
                        "interlinked",
                        model.name, density));
    }
  }
  if (!fluid.implicit() && scene.numerics.courant > 1)
    causes.push_back(
        fmt::format("steps of up to numerics.courant = {:.3g} h / c are asked for, and above about 1 the explicit "
                    "solver is unstable: "
                    "lower it",
                    scene.numerics.courant));
  if (!fluid.implicit() && step.largest_mach_before > 0.3)
    causes.push_back(
        fmt::format("the flow had reached {:.2g} times the sound speed before: raise numerics.sound_speed "
                    "({:.3g} m/s)",
                    step.largest_mach_before, c));
  if (causes.empty())
    causes.push_back(fmt::format(
        "{}, and look for bodies that start inside fluid or that are driven into walls",
        fluid.implicit() ? "set world.accuracy: accurate or numerics.pressure: wcsph" : "lower numerics.courant"));
  error.cure = fmt::format("{}; the state is in post_mortem/ (ParaView)", fmt::join(causes, "; "));
  return error;
}

}  // namespace ballast::fluid
