// The energy of the fluid against what it may have.
#include "fluid_server/step/energy.h"

#include <algorithm>
#include <cmath>

namespace ballast::fluid {

namespace {

constexpr double kPacking = 5e-3;  // density error that the packing of the particles alone makes

double total(const Measures& m) { return m.kinetic + m.potential + m.elastic; }

/// Energy that gravity would release if all fluid fell to where its lowest particle is, J; the world's gravity also
/// where the fluid's is left out (numerics.reduced_gravity).
double head(const WcsphFluid& fluid, const Vec3& g) {
  const Particles& particles = fluid.particles();
  double sum = 0, mass = 0, lowest = 1e300;
  for (std::size_t f = 0; f < particles.size(); ++f) {
    const Record& r = particles.record[f];
    const double height = -g.dot(fluid.coordinates().to_metres(r.x, r.y, r.z));  // times |g|
    const double m = static_cast<double>(fluid.fluid_of(particles.id[f]).density) * r.volume;
    lowest = std::min(lowest, height);
    sum += m * height, mass += m;
  }
  return mass > 0 ? sum - mass * lowest : 0;
}

}  // namespace

EnergyBalance::EnergyBalance(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid)
    : scene_(scene), fluid_(fluid), buoyancy_(bodies.size(), Vec3::Zero()) {
  for (int k = 0; k < 3; ++k)
    if (scene.world.periodic[static_cast<std::size_t>(k)] && scene.world.gravity[k] != 0)
      left_out_ = std::string("gravity has a component along ") + "xyz"[k] +
                  ", which is periodic, and drives the fluid without end";
  if (!scene.numerics.reduced_gravity) return;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (scene.models[b].motion == Motion::kDynamic)
      buoyancy_[b] = -fluid.filled().fluids[0].density * bodies[b].solid.mass_properties().volume * scene.world.gravity;
}

void EnergyBalance::start(const Measures& now) {
  begin_ = total(now);
  head_ = head(fluid_, scene_.world.gravity);
  // Where nothing weighs and nothing moves no energy is at play: what moves by less than a spacing a second is at rest.
  const double slow = fluid_.spacing();
  most_kinetic_ = std::max(now.kinetic, 0.5 * now.mass * slow * slow);
  most_elastic_ = now.elastic;
  // A fluid that nothing presses down takes on whatever uniform pressure the packing of its particles makes.
  const bool weightless = head_ == 0 || scene_.numerics.reduced_gravity;
  least_ = weightless ? 0.5 * kPacking * kPacking * fluid_.stiffness() : 0;
  work_ = most_work_ = gain_ = now_ = share_ = 0;
}

void EnergyBalance::step(std::span<const exchange::BodyState> before, std::span<const exchange::BodyState> after,
                         double dt) {
  for (std::size_t b = 0; b < after.size(); ++b) {
    if (scene_.models[b].motion == Motion::kStatic) continue;
    const exchange::Wrench& wrench = fluid_.wrenches()[b];
    const exchange::BodyState &old = before[b], &now = after[b];
    work_ +=
        0.5 * dt * (Vec3::Map(wrench.force) - buoyancy_[b]).dot(Vec3::Map(old.velocity) + Vec3::Map(now.velocity)) +
        0.5 * dt * Vec3::Map(wrench.torque).dot(Vec3::Map(old.angular_velocity) + Vec3::Map(now.angular_velocity));
  }
  most_work_ = std::max(most_work_, std::abs(work_));
}

void EnergyBalance::jump(const Measures& before, const Measures& after) {
  begin_ += total(after) - total(before);
  head_ = std::max(head_, head(fluid_, scene_.world.gravity));
}

void EnergyBalance::measure(const Measures& now) {
  if (!left_out_.empty()) return;
  most_kinetic_ = std::max(most_kinetic_, now.kinetic);
  most_elastic_ = std::max(most_elastic_, now.elastic);
  gain_ = total(now) + fluid_.energy_lost() + work_ - begin_;
  now_ = gain_ / reference();
  share_ = std::max(share_, now_);
}

double EnergyBalance::reference() const { return std::max(head_ + most_kinetic_ + most_elastic_ + most_work_, least_); }

}  // namespace ballast::fluid
