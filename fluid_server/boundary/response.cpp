// Sample pressure, wrenches and body accelerations.
#include "fluid_server/boundary/response.h"

#include <Eigen/Dense>
#include <algorithm>

#include "fluid_server/neighbours/shares.h"

namespace ballast::fluid {

Response::Response(const Samples& samples, std::vector<Vec3> buoyancy, std::unique_ptr<Seepage> films, double spacing,
                   int threads)
    : samples_(samples),
      threads_(threads),
      spacing_(spacing),
      buoyancy_(std::move(buoyancy)),
      films_(std::move(films)) {
  const std::size_t bodies = buoyancy_.size();
  at_.assign(samples.size(), 0);
  wrenches_.resize(bodies);
  acceleration_.resize(bodies);
  spin_.resize(bodies);
  constexpr std::uint32_t kChunk = 1024;
  for (std::uint32_t b = 0; b < bodies; ++b)
    for (std::uint32_t k = samples.first[b]; k < samples.first[b + 1]; k += kChunk)
      chunks_.push_back({b, k, std::min(k + kChunk, samples.first[b + 1])});
}

void Response::solve(Neighbourhood& items, ItemExtras& extras, const std::vector<SampleSums>& sums,
                     const PassConstants& constants, std::span<const exchange::BodyState> states, Scheme scheme,
                     Films films) {
  scheme_ = scheme;
  collect(items, extras, sums, constants, states);
  if (films_ && films == Films::kFollow) {
    films_->solve(states, [&](std::uint32_t sample) -> std::optional<Seepage::Wet> {
      const Wet* wet = find(sample);
      if (!wet) return {};
      return Seepage::Wet{wet->p0, wet->seen, wet->area.cast<double>(), sums[at_[sample]].share};
    });
    if (!films_->empty()) find_accelerations(states, scheme, false);
    films_->press(states, acceleration_, constants.dt);
  }
  find_accelerations(states, scheme, true);
  apply(items, states);
}

void Response::place_normals(const Neighbourhood& items, std::span<const exchange::BodyState> states,
                             ItemExtras& extras) const {
  std::vector<Eigen::Matrix3f> rotation;
  for (const exchange::BodyState& state : states)
    rotation.push_back(rotation_of(state).toRotationMatrix().cast<float>());
  extras.normal.resize(items.size());
#pragma omp parallel for num_threads(threads_) schedule(static)
  for (std::size_t s = 0; s < items.sample_item.size(); ++s) {
    const std::uint32_t item = items.sample_item[s], sample = items.source[item] & ~Neighbourhood::kSample;
    const Eigen::Vector3f n = rotation[samples_.body[sample]] * samples_.normal[sample];
    extras.normal[item] = {n[0], n[1], n[2], 0.f};
  }
}

/// By how much the velocity of the fluid that a sample sees is taken to go on beyond the surface, where it is that of
/// the body: linearly, depth over height. Where no side of the surface can be told (a plate thinner than the samples
/// reach, a rim) as much on the one side as on the other.
float Response::mirror(float depth, float height) const {
  constexpr float kTooLow = 0.1f, kMost = 12;  // spacings; share
  if (height < kTooLow * static_cast<float>(spacing_)) return 1;
  return std::min(depth / height, kMost);
}

void Response::collect(Neighbourhood& items, ItemExtras& extras, const std::vector<SampleSums>& sums,
                       const PassConstants& constants, std::span<const exchange::BodyState> states) {
  const Eigen::Vector3f gravity = Eigen::Vector3f::Map(constants.gravity);
  if (constants.viscous) gather_viscous(items, extras, constants, viscous_);
  drag_.assign(constants.viscous ? sums.size() : 0, {1, Eigen::Vector3f::Zero()});
  resize_gently(wet_, sums.size());
#pragma omp parallel for num_threads(threads_) schedule(static, Lists::kChunk)
  for (std::size_t s = 0; s < sums.size(); ++s) {
    const SampleSums& sum = sums[s];
    const std::uint32_t item = items.sample_item[s], sample = items.source[item] & ~Neighbourhood::kSample;
    Record& record = items.record[item];
    record.p = 0;
    if (constants.viscous) extras.viscous[item] = {record.vx, record.vy, record.vz, -1.f};
    Wet& wet = wet_[s];
    wet.sample = kDry;
    if (!(sum.w > 0)) continue;
    wet.sample = sample;
    at_[sample] = static_cast<std::uint32_t>(s);
    const float volume = samples_.volume[sample];
    wet.item = item;
    wet.body = samples_.body[sample];
    const exchange::BodyState& state = states[wet.body];
    const Quat q = rotation_of(state);
    wet.arm = (q * samples_.local[sample].cast<double>()).cast<float>();
    wet.penetration = 0.5f * static_cast<float>(spacing_) - (sum.nearest - samples_.depth[sample]);
    const Eigen::Vector3f reach = Eigen::Vector3f::Map(sum.wr) / sum.w;
    wet.seen = sum.wp / sum.w + gravity.dot(reach);
    wet.reach = sum.share * reach;
    wet.p0 = sum.share * wet.seen;
    wet.area = -volume * Eigen::Vector3f::Map(sum.g);
    wet.force = -volume * Eigen::Vector3f::Map(sum.pg);
    if (constants.viscous) {
      const ViscousSums& viscous = viscous_[s];
      const Eigen::Vector3f normal = q.cast<float>() * samples_.normal[sample], depth = samples_.depth[sample] * normal;
      const Eigen::Vector3f spin = Vec3::Map(state.angular_velocity).cast<float>();
      const Eigen::Vector3f surface = Eigen::Vector3f(record.vx, record.vy, record.vz) + spin.cross(depth);
      const float height = -normal.dot(Eigen::Vector3f::Map(viscous.wd)) / sum.w - samples_.depth[sample];
      drag_[s].mirror = mirror(samples_.depth[sample], height);
      const Eigen::Vector3f seen = surface + drag_[s].mirror * (surface - Eigen::Vector3f::Map(viscous.wv) / sum.w);
      extras.viscous[item] = {seen[0], seen[1], seen[2], -1.f};
      const Eigen::Vector3f drag = volume * (viscous.a * seen - Eigen::Vector3f::Map(viscous.av));
      wet.force += drag;
      // Both act at the surface; the pairs' sum is mu du/dn and lacks mu (grad u)^T n, which is mu n x spin on a body.
      const Eigen::Vector3f turned = -volume * spin.cross(Eigen::Vector3f::Map(viscous.ar));
      drag_[s].couple = depth.cross(drag) + (wet.arm + depth).cross(turned);
    }
  }
}

double Response::drag_rate(const Neighbourhood& items, const std::vector<SampleSums>& sums,
                           std::span<const exchange::BodyState> states) const {
  std::vector<Matrix6> drag(states.size(), Matrix6::Zero());
  for (std::size_t s = 0; s < sums.size(); ++s) {
    if (!(sums[s].w > 0)) continue;
    const std::uint32_t sample = items.source[items.sample_item[s]] & ~Neighbourhood::kSample;
    const Vec3 arm = wet_[s].arm.cast<double>();
    Eigen::Matrix<double, 3, 6> velocity;  // of the sample, from the body's twist
    velocity.leftCols<3>().setIdentity();
    for (int k = 0; k < 3; ++k) velocity.col(3 + k) = Vec3::Unit(k).cross(arm);
    // What a sample is taken to move at changes more than it does: v + mirror (v - v_fluid).
    drag[samples_.body[sample]] -=
        (1 + drag_[s].mirror) * samples_.volume[sample] * viscous_[s].a * velocity.transpose() * velocity;
  }
  double fastest = 0;
  for (std::size_t b = 0; b < states.size(); ++b) {
    const auto mobility = mobility_of(states[b]);
    if (mobility.isZero(0)) continue;
    fastest = std::max(fastest, (mobility * drag[b]).eigenvalues().real().maxCoeff());
  }
  return fastest;
}

Vector6 Response::film(std::size_t body) const {
  Vector6 wrench = Vector6::Zero();
  if (films_) wrench << Vec3::Map(films_->wrenches()[body].force), Vec3::Map(films_->wrenches()[body].torque);
  return wrench;
}

void Response::find_accelerations(std::span<const exchange::BodyState> states, Scheme scheme, bool films) {
  for_each_by_turns(states.size(), threads_, [&](std::size_t b) {
    const Vector6 free = Vector6::Map(states[b].free_acceleration);
    const auto mobility = mobility_of(states[b]);
    spin_[b] = Vec3::Map(states[b].angular_velocity);
    acceleration_[b] = free;
    if (mobility.isZero(0)) return;  // static or prescribed: moves as it moves
    Vector6 taken = Vector6::Zero();
    if (scheme == Scheme::kStaggered) taken = Vector6::Map(states[b].acceleration);
    if (scheme == Scheme::kLeftOut) spin_[b].setZero();  // nor what turning accelerates
    if (scheme != Scheme::kInterlinked && films) {
      acceleration_[b] = taken;
      return;
    }
    Vector6 force = films ? film(b) : Vector6(Vector6::Zero());
    force.head<3>() += buoyancy_[b];
    const Matrix6 added = added_mass(static_cast<std::uint32_t>(b));
    for_each_wet(*this, static_cast<std::uint32_t>(b), [&](const Wet& wet) {
      const Vec3 arm = wet.arm.cast<double>(), area = wet.area.cast<double>(), reach = wet.reach.cast<double>();
      Vector6 per_pressure;
      per_pressure << area, arm.cross(area);
      const Vec3 centripetal = spin_[b].cross(spin_[b].cross(arm));
      const Vec3 known = wet.force.cast<double>();
      force.head<3>() += known;
      force.tail<3>() += arm.cross(known) + couple(wet);
      force += per_pressure * (wet.p0 - centripetal.dot(reach));
    });
    if (scheme == Scheme::kInterlinked)
      acceleration_[b] = (Matrix6::Identity() + mobility * added).partialPivLu().solve(free + mobility * force);
    else
      acceleration_[b] = free + mobility * (force - added * taken);
  });
}

void Response::apply(Neighbourhood& items, std::span<const exchange::BodyState> states) {
  for_each_by_turns(chunks_.size(), threads_, [&](std::size_t at) {
    Chunk& chunk = chunks_[at];
    const std::uint32_t b = chunk.body;
    const Vec3 linear = acceleration_[b].head<3>(), angular = acceleration_[b].tail<3>();
    chunk.force.setZero(), chunk.torque.setZero();
    for (std::uint32_t k = chunk.begin; k < chunk.end; ++k) {
      Wet* const found = find(samples_.order[k]);
      if (!found) continue;
      Wet& wet = *found;
      const Vec3 arm = wet.arm.cast<double>();
      const Vec3 own = linear + angular.cross(arm) + spin_[b].cross(spin_[b].cross(arm));
      const float p = wet.p0 - own.cast<float>().dot(wet.reach);
      items.record[wet.item].p = p;
      wet.force += p * wet.area;
      const Vec3 f = wet.force.cast<double>();
      chunk.force += f;
      chunk.torque += arm.cross(f) + couple(wet);
    }
  });
  for (std::size_t b = 0; b < states.size(); ++b) {
    Vec3::Map(wrenches_[b].force) = buoyancy_[b] + film(b).head<3>();
    Vec3::Map(wrenches_[b].torque) = film(b).tail<3>();
  }
  for (const Chunk& chunk : chunks_) {
    Vec3::Map(wrenches_[chunk.body].force) += chunk.force;
    Vec3::Map(wrenches_[chunk.body].torque) += chunk.torque;
  }
}

Matrix6 Response::added_mass(std::uint32_t body) const {
  Matrix6 added = Matrix6::Zero();
  for_each_wet(*this, body, [&](const Wet& wet) {
    const Vec3 arm = wet.arm.cast<double>(), area = wet.area.cast<double>(), reach = wet.reach.cast<double>();
    Vector6 per_pressure, per_acceleration;
    per_pressure << area, arm.cross(area);
    per_acceleration << reach, arm.cross(reach);  // a_b . reach with a_b = a + alpha x arm + centripetal
    added.noalias() += per_pressure * per_acceleration.transpose();
  });
  return added;
}

Matrix6 Response::mobility_in_water(const exchange::BodyState& state, std::uint32_t body) const {
  const Matrix6 mobility = mobility_of(state);
  if (scheme_ == Scheme::kStaggered || mobility.isZero(0)) return mobility;
  return (Matrix6::Identity() + mobility * added_mass(body)).partialPivLu().solve(mobility);
}

void Response::accelerate_body(Neighbourhood& items, std::uint32_t body, const Vector6& change) {
  if (scheme_ == Scheme::kStaggered) return;
  acceleration_[body] += change;
  exchange::Wrench& wrench = wrenches_[body];
  for_each_wet(*this, body, [&](Wet& wet) {
    const Vec3 arm = wet.arm.cast<double>(), own = change.head<3>() + change.tail<3>().cross(arm);
    const float p = -own.cast<float>().dot(wet.reach);
    items.record[wet.item].p += p;
    const Eigen::Vector3f force = p * wet.area;
    wet.force += force;
    Vec3::Map(wrench.force) += force.cast<double>();
    Vec3::Map(wrench.torque) += arm.cross(force.cast<double>());
  });
}

Vec3 Response::acceleration_of(std::uint32_t sample) const {
  const Wet* wet = find(sample);
  if (!wet) return Vec3::Zero();
  const std::uint32_t b = wet->body;
  const Vec3 arm = wet->arm.cast<double>();
  return acceleration_[b].head<3>() + acceleration_[b].tail<3>().cross(arm) + spin_[b].cross(spin_[b].cross(arm));
}

void Response::push(std::uint32_t sample, const Vec3& arm, const Vec3& force) {
  exchange::Wrench& wrench = wrenches_[samples_.body[sample]];
  Vec3::Map(wrench.force) += force;
  Vec3::Map(wrench.torque) += arm.cross(force);
  if (Wet* wet = find(sample)) wet->force += force.cast<float>();
}

std::span<const exchange::Contact> Response::gather_contacts(std::span<const exchange::BodyState> states) {
  patches_.assign(samples_.patch_body.size(), {});
  std::vector<Eigen::Matrix3d> rotation;
  for (const exchange::BodyState& state : states) rotation.push_back(rotation_of(state).toRotationMatrix());
  for (std::uint32_t sample = samples_.first_moving; sample < samples_.size(); ++sample) {
    const Wet* const found = find(sample);
    if (!found) continue;
    const Wet& wet = *found;
    exchange::Contact& patch = patches_[samples_.patch[sample]];
    const Vec3 normal = rotation[wet.body] * samples_.normal[sample].cast<double>();
    const Vec3 force = wet.force.cast<double>();
    patch.body = wet.body;
    patch.depth = patch.samples ? std::max<double>(patch.depth, wet.penetration) : wet.penetration;
    ++patch.samples;
    Vec3::Map(patch.position) +=
        Vec3::Map(states[wet.body].position) + wet.arm.cast<double>() + samples_.depth[sample] * normal;
    Vec3::Map(patch.normal) += normal;
    Vec3::Map(patch.force) += force;
    // only the first layer, half a pitch inside, stands for surface
    if (samples_.depth[sample] < 0.75 * spacing_) patch.area += samples_.volume[sample] / (2 * samples_.depth[sample]);
  }
  contacts_.clear();
  for (auto& patch : patches_) {
    if (!patch.samples) continue;
    Vec3::Map(patch.position) /= patch.samples;
    Vec3::Map(patch.normal).normalize();
    contacts_.push_back(patch);
  }
  return contacts_;
}

}  // namespace ballast::fluid
