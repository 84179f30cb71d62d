// Inelastic contact between particles and solids.
#include "fluid_server/boundary/barrier.h"

#include <algorithm>
#include <tuple>

namespace ballast::fluid {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

// Of a spacing: particles farther than this from every sample are at least 0.1 spacings above every surface.
constexpr double kNear = 0.95;
constexpr double kComeOut = 0.2;    // of its depth that a particle rises in a step
constexpr int kContactSweeps = 30;  // over contacts, at most

}  // namespace

Barrier::Barrier(const Samples& samples, std::span<const Body> bodies, double spacing)
    : samples_(samples), bodies_(bodies), spacing_(spacing) {}

void Barrier::solve(const Neighbourhood& items, const ItemExtras& extras, const std::vector<SampleSums>& sums,
                    const PassConstants& constants, std::span<const exchange::BodyState> states, Response& response) {
  pushes_.clear();
  find_near(items, sums);
  if (contacts_.empty()) return;
  find_touching(items, extras, constants, states);
  const double dt = constants.dt;
  motion_.assign(states.size(), Vector6::Zero());
  const auto mobility = [&](std::uint32_t b) { return mobility_of(states[b]); };
  for (int sweep = 0; sweep < kContactSweeps; ++sweep) {
    bool changed = false;
    for (Contact& c : contacts_) {
      const Vec3 body = motion_[c.body].head<3>() + motion_[c.body].tail<3>().cross(c.arm);
      const double separation = c.normal.dot(pushes_[c.slot].gain.cast<double>() - body);
      const double impulse = std::max(0.0, c.impulse + (c.least - separation) / c.inverse_mass);
      const double change = impulse - c.impulse;
      if (change == 0) continue;
      changed |= std::abs(change) > 1e-6 * impulse;
      c.impulse = impulse;
      pushes_[c.slot].gain += (change / c.mass * c.normal).cast<float>();
      Vector6 reaction;
      reaction << -change * c.normal, c.arm.cross(-change * c.normal);
      motion_[c.body] += mobility(c.body) * reaction;
    }
    if (!changed) break;
  }
  for (const Contact& c : contacts_) {
    if (!(c.impulse > 0)) continue;
    response.push(c.sample, c.arm, -c.impulse / dt * c.normal);
    report_.impulse += c.impulse;
    ++report_.pushes;
  }
}

/// Pairs of a particle and a solid that are near each other, each with the nearest sample.
void Barrier::find_near(const Neighbourhood& items, const std::vector<SampleSums>& sums) {
  contacts_.clear();
  const Coordinates& coordinates = items.coordinates();
  const float near2 = static_cast<float>(kNear * kNear * spacing_ * spacing_);
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (!(sums[s].w > 0) || sums[s].nearest * sums[s].nearest > near2) continue;
    const std::uint32_t item = items.sample_item[s], sample = items.source[item] & ~Neighbourhood::kSample;
    const std::uint32_t* list = items.lists.of(item);
    for (std::uint32_t k = 0; k < items.lists.count[item]; ++k) {
      const Record &a = items.record[list[k]], &b = items.record[item];
      const auto distance2 = static_cast<float>(coordinates.difference({a.x, a.y, a.z}, {b.x, b.y, b.z}).squaredNorm());
      if (distance2 < near2) {
        Contact& c = contacts_.emplace_back();
        c.particle = items.source[list[k]], c.body = samples_.body[sample], c.sample = sample, c.distance2 = distance2;
      }
    }
  }
  // What does not move comes last among a particle's solids: its contact is the one that a sweep ends with.
  const auto order = [&](const Contact& c) {
    return std::tuple(c.particle, c.sample < samples_.first_moving, c.body, c.distance2, c.sample);
  };
  std::sort(contacts_.begin(), contacts_.end(), [&](const auto& a, const auto& b) { return order(a) < order(b); });
  const auto same = [](const Contact& a, const Contact& b) { return a.particle == b.particle && a.body == b.body; };
  contacts_.erase(std::unique(contacts_.begin(), contacts_.end(), same), contacts_.end());
}

/// Of those, the ones that meet in this step; what their velocities would be without the barrier goes into `least`.
void Barrier::find_touching(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                            std::span<const exchange::BodyState> states) {
  const Coordinates& coordinates = items.coordinates();
  const double dt = constants.dt;
  particles_.clear();
  for (Contact& c : contacts_) {
    if (particles_.empty() || particles_.back() != c.particle) particles_.push_back(c.particle);
    c.slot = static_cast<std::uint32_t>(particles_.size() - 1);
  }
  accelerate_some(items, extras, constants, particles_, acceleration_);
  std::erase_if(contacts_, [&](Contact& c) {
    const exchange::BodyState& state = states[c.body];
    const Quat q = rotation_of(state);
    const Record& own = items.record[items.fluid_item[c.particle]];
    const Record& sample = samples_.record[c.sample];
    const Vec3 from_sample = coordinates.difference({own.x, own.y, own.z}, {sample.x, sample.y, sample.z});
    const Vec3 local = samples_.local[c.sample].cast<double>() + q.conjugate() * from_sample;
    const double height = bodies_[c.body].solid.distance(local);
    c.arm = q * local;
    const Vec3 body = Vec3::Map(state.velocity) + Vec3::Map(state.angular_velocity).cross(c.arm);
    const Vec3 velocity =
        Vec3(own.vx, own.vy, own.vz) + dt * Eigen::Vector3f::Map(&acceleration_[3 * c.slot]).cast<double>();
    const Vec3 relative = velocity - body;
    // no direction brings it nearer than its speed
    if (height > dt * relative.norm()) return true;
    c.normal = q * bodies_[c.body].solid.normal(local);
    c.least = (height >= 0 ? -height : -kComeOut * height) / dt - c.normal.dot(relative);
    report_.deepest = std::max(report_.deepest, -height);
    const auto mobility = mobility_of(state);
    Vector6 line;
    line << c.normal, c.arm.cross(c.normal);
    c.mass = own.volume * extras.density[constants.several_densities ? items.fluid_item[c.particle] : 0];
    c.inverse_mass = 1 / c.mass + line.dot(mobility * line);
    return false;
  });
  pushes_.resize(particles_.size());
  for (std::size_t k = 0; k < particles_.size(); ++k) pushes_[k] = {particles_[k], Eigen::Vector3f::Zero()};
}

}  // namespace ballast::fluid
