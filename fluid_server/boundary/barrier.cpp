// Inelastic contact between particles and solids.
#include "fluid_server/boundary/barrier.h"

#include <Eigen/Dense>
#include <algorithm>
#include <tuple>

#include "fluid_server/neighbours/shares.h"
#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

// Of a spacing: particles farther than this from every sample are at least 0.1 spacings above every surface.
constexpr double kNear = 0.95;
// In short steps a particle is not stopped in one but over this way, in spacings, or as many steps: a blow of one step
// would be many g for a light body.
constexpr double kBrake = 0.25, kMostSteps = 20;
constexpr double kComeOut = 0.2;          // of its depth that a particle rises in a step
constexpr int kContactSweeps = 30;        // over contacts, at most
constexpr int kPasses = 3;                // with the pressure that bodies in contact put on the water
constexpr std::size_t kFewContacts = 64;  // below this a second thread costs more than it brings

}  // namespace

Barrier::Barrier(const Samples& samples, std::span<const Body> bodies, double spacing, bool brakes)
    : samples_(samples), bodies_(bodies), spacing_(spacing), brakes_(brakes) {}

void Barrier::solve(Neighbourhood& items, const ItemExtras& extras, const std::vector<SampleSums>& sums,
                    const PassConstants& constants, std::span<const exchange::BodyState> states, Response& response) {
  pushes_.clear();
  find_near(items, constants, sums);
  if (contacts_.empty()) return;
  find_touching(items, extras, constants, states, response);
  const double dt = constants.dt;
  motion_.assign(states.size(), Vector6::Zero());
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<Vector6> before = motion_;
    share_out(false);
    if (motion_ == before) break;
    for_each_by_turns(states.size(), contacts_.size() > kFewContacts ? constants.threads : 1, [&](std::size_t b) {
      if (motion_[b] != before[b])
        response.accelerate_body(items, static_cast<std::uint32_t>(b), (motion_[b] - before[b]) / dt);
    });
    // The pressure that a body's change puts on the water drives the particles, too.
    const std::vector<float> old = acceleration_;
    accelerate_some(items, extras, constants, particles_, acceleration_);
    for (Contact& c : contacts_)
      for (int k = 0; k < 3; ++k) c.least += dt * c.normal[k] * (old[3 * c.slot + k] - acceleration_[3 * c.slot + k]);
    if (pass + 1 == kPasses) share_out(true);
  }
  for (const Contact& c : contacts_) {
    if (!(c.impulse > 0)) continue;
    response.push(c.sample, c.arm, -c.impulse / dt * c.normal);
    report_.impulse += c.impulse;
    ++report_.pushes;
  }
}

/// Impulses that leave no contact slower than its least separation, none of them a pull. `still`: only at what does not
/// move.
void Barrier::share_out(bool still) {
  for (int sweep = 0; sweep < kContactSweeps; ++sweep) {
    bool changed = false;
    for (Contact& c : contacts_) {
      if (still && !mobility_[c.body].isZero(0)) continue;
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
      motion_[c.body] += mobility_[c.body] * reaction;
    }
    if (!changed) break;
  }
}

/// Pairs of a particle and a solid that are near each other, each with the nearest sample.
void Barrier::find_near(const Neighbourhood& items, const PassConstants& constants,
                        const std::vector<SampleSums>& sums) {
  contacts_.clear();
  const Coordinates& coordinates = items.coordinates();
  const float near2 = static_cast<float>(kNear * kNear * spacing_ * spacing_);
  near_.resize((sums.size() + kSumBlock - 1) / kSumBlock);
  for_blocks(sums.size(), constants.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Near>& near = near_[begin / kSumBlock];
    near.clear();
    for (std::size_t s = begin; s < end; ++s) {
      if (!(sums[s].w > 0) || sums[s].nearest * sums[s].nearest > near2) continue;
      const std::uint32_t item = items.sample_item[s], sample = items.source[item] & ~Neighbourhood::kSample;
      const std::uint32_t* list = items.lists.of(item);
      for (std::uint32_t k = 0; k < items.lists.count[item]; ++k) {
        const Record &a = items.record[list[k]], &b = items.record[item];
        const auto distance2 =
            static_cast<float>(coordinates.difference({a.x, a.y, a.z}, {b.x, b.y, b.z}).squaredNorm());
        if (!(distance2 < near2)) continue;
        near.push_back({items.source[list[k]], samples_.body[sample], sample, distance2});
      }
    }
  });
  std::vector<Near> all;
  for (const std::vector<Near>& near : near_) all.insert(all.end(), near.begin(), near.end());
  // What does not move comes last among a particle's solids: its contact is the one that a sweep ends with.
  const auto order = [&](const Near& n) {
    return std::tuple(n.particle, n.sample < samples_.first_moving, n.body, n.distance2, n.sample);
  };
  std::ranges::sort(all, {}, order);
  for (const Near& n : all) {
    if (!contacts_.empty() && contacts_.back().particle == n.particle && contacts_.back().body == n.body) continue;
    Contact& c = contacts_.emplace_back();
    c.particle = n.particle, c.body = n.body, c.sample = n.sample;
  }
}

/// Leaves only the particles of contacts, with their accelerations.
void Barrier::keep_touching() {
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact& c = contacts_[k];
    if (k == 0 || c.particle != contacts_[k - 1].particle) {
      std::copy_n(&acceleration_[3 * c.slot], 3, &acceleration_[3 * count]);
      particles_[count++] = c.particle;
    }
    c.slot = count - 1;
  }
  particles_.resize(count);
  acceleration_.resize(3 * count);
}

/// Of those, the ones that meet in this step; what their velocities would be without the barrier goes into `least`.
void Barrier::find_touching(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                            std::span<const exchange::BodyState> states, const Response& response) {
  const Coordinates& coordinates = items.coordinates();
  const double dt = constants.dt;
  particles_.clear();
  for (Contact& c : contacts_) {
    if (particles_.empty() || particles_.back() != c.particle) particles_.push_back(c.particle);
    c.slot = static_cast<std::uint32_t>(particles_.size() - 1);
  }
  accelerate_some(items, extras, constants, particles_, acceleration_);
  const auto meet = [&](Contact& c) {
    const exchange::BodyState& state = states[c.body];
    const Quat q = rotation_of(state);
    const Record& own = items.record[items.fluid_item[c.particle]];
    const Record& sample = samples_.record[c.sample];
    const Vec3 from_sample = coordinates.difference({own.x, own.y, own.z}, {sample.x, sample.y, sample.z});
    const Vec3 local = samples_.local[c.sample].cast<double>() + q.conjugate() * from_sample;
    c.height = bodies_[c.body].solid.distance(local);
    c.arm = q * local;
    const Vec3 body = Vec3::Map(state.velocity) + Vec3::Map(state.angular_velocity).cross(c.arm);
    const Vec3 velocity =
        Vec3(own.vx, own.vy, own.vz) + dt * Eigen::Vector3f::Map(&acceleration_[3 * c.slot]).cast<double>();
    const Vec3 relative = velocity - body;
    const double speed = relative.norm();
    const double brake = brakes_ && speed > 0 ? std::clamp(kBrake * spacing_ / speed, dt, kMostSteps * dt) : dt;
    c.meets = c.height <= brake * speed;  // no direction brings it nearer than its speed
    if (!c.meets) return;
    c.normal = q * bodies_[c.body].solid.normal(local);
    c.least = (c.height >= 0 ? -c.height / brake : -kComeOut * c.height / dt) - c.normal.dot(relative);
    c.mass = own.volume * extras.density[constants.several_densities ? items.fluid_item[c.particle] : 0];
  };
#pragma omp parallel for num_threads(constants.threads) schedule(static) if (contacts_.size() > kFewContacts)
  for (std::size_t k = 0; k < contacts_.size(); ++k) meet(contacts_[k]);
  std::erase_if(contacts_, [](const Contact& c) { return !c.meets; });
  keep_touching();
  mobility_.assign(states.size(), Matrix6::Zero());
  std::vector<std::uint8_t> touched(states.size(), 0);
  for (const Contact& c : contacts_) touched[c.body] = 1;
  for_each_by_turns(states.size(), contacts_.size() > kFewContacts ? constants.threads : 1, [&](std::size_t b) {
    if (touched[b]) mobility_[b] = response.mobility_in_water(states[b], static_cast<std::uint32_t>(b));
  });
  for (Contact& c : contacts_) {
    report_.deepest = std::max(report_.deepest, -c.height);
    Vector6 line;
    line << c.normal, c.arm.cross(c.normal);
    c.inverse_mass = 1 / c.mass + line.dot(mobility_[c.body] * line);
  }
  pushes_.resize(particles_.size());
  for (std::size_t k = 0; k < particles_.size(); ++k) pushes_[k] = {particles_[k], Eigen::Vector3f::Zero()};
}

}  // namespace ballast::fluid
