// The system of a step, and the pressure at the moment of release.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "fluid_server/particles/extent.h"
#include "fluid_server/pressure/implicit.h"
#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

// Of the mean diagonal: what a row has at least. A particle between solids that no pressure moves would ask for any.
constexpr double kYielding = 0.05;
constexpr float kStiffer = 4;      // sound speed, of the explicit solver's
constexpr double kReach = 3;       // radians of the slowest wave in the step at release
constexpr int kMostRounds = 100;   // at release
constexpr double kSettled = 1e-3;  // change of pressure in a round, of the largest

}  // namespace

/// Wrenches and accelerations without the fluid's pressure, with the sums of samples that they need.
void ImplicitPressure::without_pressure(std::span<const exchange::BodyState> states, Response& response,
                                        std::vector<SampleSums>& sums) {
  gather_samples(*items_, *extras_, *constants_, sums);
  scale(sums);
  response.solve(*items_, *extras_, sums, *constants_, states, Scheme::kLeftOut, Films::kStay);
  accelerate(*items_, *extras_, *constants_, *acceleration_);
  inverse_w_.resize(sums.size());
  for_blocks(sums.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) inverse_w_[s] = sums[s].w > 0 ? share_[s] / sums[s].w : 0.f;
  });
}

/// All but the right side: velocities without the fluid's pressure and their divergence, rows of bodies, diagonal.
void ImplicitPressure::set_up(const Particles& particles, std::span<const exchange::BodyState> states,
                              const Response& response, const std::vector<SampleSums>& sums) {
  Neighbourhood& items = *items_;
  const ItemExtras& extras = *extras_;
  predict(states, response);
  std::vector<float>& invariant = right_;  // not yet known
  apply_divergence(items, *constants_, inverse_w_, flow_, divergence_, invariant);
  if (!at_release_) add_second_order(particles, invariant);
  bodies_.build(items, samples_, states, sums, inverse_w_, pairs_, *constants_, dt_);
  weigh_samples(items, inverse_w_, constants_->threads, pairs_, flow_);
  find_diagonal(items, extras, *constants_, rows_, pairs_, diagonal_);

  const std::size_t n = particles.size();
  const int threads = constants_->threads;
  yielding_.resize(n), right_.resize(n), bounded_.resize(n), source_.resize(n);
  const double dt2 = dt_ * dt_;
  const auto [trace] = sum_of<1>(n, threads, [&](std::size_t f, auto& sum) { sum[0] += diagonal_[f] * dt2; });
  mean_diagonal_ = trace / static_cast<double>(std::max<std::size_t>(n, 1));
  const float least = static_cast<float>(kYielding * mean_diagonal_);
  for_blocks(n, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const float diagonal = static_cast<float>(diagonal_[f] * dt2);
      yielding_[f] = std::max(least - diagonal, 0.f) + particles.record[f].volume * softness(f);
      diagonal_[f] = diagonal + yielding_[f];
      bounded_[f] = rows_[f].fullness < kInside;
    }
  });
  hold_squeezed();
}

/// What straight moves x + dt v of particles do to the volume beyond dt div v: det(1 + dt L) = 1 + dt div v + dt^2 Q,
/// with Q for a flow without divergence, as it will be. Strain compresses, rotation expands. Less and less towards a
/// surface, where nothing hinders it. What is below the tolerance is left out: noise of the velocities looks like
/// strain, and would lift still water.
void ImplicitPressure::add_second_order(const Particles& particles, std::span<const float> invariant) {
  const float dt = static_cast<float>(dt_), seen = static_cast<float>(options_.tolerance);
  for_blocks(particles.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const float depth = std::clamp((rows_[f].fullness - kInside) / (1 - kInside), 0.f, 1.f);
      const float gained = dt * dt * invariant[f];
      divergence_[f] += depth * particles.record[f].volume * (gained - std::clamp(gained, -seen, seen)) / dt;
    }
  });
}

/// Compression that a unit of pressure bears, 1/Pa.
float ImplicitPressure::softness(std::size_t f) const {
  const float speed = kStiffer * constants_->sound_speed;
  return 1 / (extras_->density_of(items_->fluid_item[f]) * speed * speed);
}

/// Velocities at the end of the step without the fluid's pressure.
void ImplicitPressure::predict(std::span<const exchange::BodyState> states, const Response& response) {
  Neighbourhood& items = *items_;
  resize_gently(flow_, items.record.size());
  const float dt = static_cast<float>(dt_);
  for_blocks(items.fluid_item.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Record& r = items.record[items.fluid_item[f]];
      const float* a = &(*acceleration_)[3 * f];
      flow_[items.fluid_item[f]] = {r.vx + dt * a[0], r.vy + dt * a[1], r.vz + dt * a[2], r.volume};
    }
  });
  start_.resize(states.size());
  for (std::size_t b = 0; b < states.size(); ++b) {
    const auto mobility = mobility_of(states[b]);
    Vector6 wrench;
    wrench << Vec3::Map(response.wrenches()[b].force), Vec3::Map(response.wrenches()[b].torque);
    start_[b] = Vector6::Map(states[b].free_acceleration) + mobility * wrench;
  }
  for_blocks(items.sample_item.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::uint32_t item = items.sample_item[s], sample = items.source[item] & ~Neighbourhood::kSample;
      const Record& r = items.record[item];
      flow_[item] = at_release_ ? Flow{0, 0, 0, r.volume} : Flow{r.vx, r.vy, r.vz, r.volume};
      const std::uint32_t body = samples_.body[sample];
      if (sample < samples_.first_moving) continue;
      const exchange::BodyState& state = states[body];
      const Quat q = rotation_of(state);
      const Vec3 arm = q * samples_.local[sample].cast<double>();
      const Vec3 gain = dt_ * (start_[body].head<3>() + start_[body].tail<3>().cross(arm));
      flow_[item].x += static_cast<float>(gain[0]);
      flow_[item].y += static_cast<float>(gain[1]);
      flow_[item].z += static_cast<float>(gain[2]);
    }
  });
}

/// Before the first step of a fluid that does not move yet, which may be repeated.
bool ImplicitPressure::untouched(const Particles& particles) {
  return particles.at_rest() &&
         std::all_of(particles.compression.begin(), particles.compression.end(), [](float e) { return e == 0; });
}

/// A fluid at rest bears the pressure of its release from the first step on: what that compresses, p / (rho c^2), is
/// there from the start. Otherwise all water would sink by it in the first steps, at centimetres a second, and take
/// what floats along. Rounds of the same system, of accelerations alone, each with the compression that the round
/// before asks for; in a step so long that they settle soon: the pressure at release does not depend on it. Walls and
/// bodies in motion push and drag later: they count as at rest.
void ImplicitPressure::release(Particles& particles, std::span<const exchange::BodyState> states, Response& response,
                               std::vector<SampleSums>& sums) {
  PassConstants still = *constants_;
  still.viscous = still.ram_on_samples = false;
  const PassConstants* usual = std::exchange(constants_, &still);
  without_pressure(states, response, sums);
  const ImplicitOptions options = options_;
  const double dt = dt_;
  dt_ = std::max(dt, kReach / (kStiffer * constants_->sound_speed * slowest_wave(particles)));
  options_.tolerance *= (dt_ / dt) * (dt_ / dt);
  at_release_ = true;
  set_up(particles, states, response, sums);
  const std::size_t n = particles.size();
  for (report_.release_rounds = 1;; ++report_.release_rounds) {
    last_ = pressure_;
    for_blocks(n, constants_->threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) source_[f] = softness(f) * pressure_[f];
    });
    find_pressure(particles);
    float change = 0, largest = 0;
    for (std::size_t f = 0; f < n; ++f) {
      change = std::max(change, std::abs(pressure_[f] - last_[f]));
      largest = std::max(largest, std::abs(pressure_[f]));
    }
    report_.release_change = largest > 0 ? static_cast<double>(change) / largest : 0;
    if (report_.release_change < kSettled || report_.release_rounds == kMostRounds) break;
    if (response.films() && (report_.release_rounds == 1 || !response.films()->empty())) {  // hang on the pressure
      follow_films(states, response, sums);
      set_up(particles, states, response, sums);
    }
  }
  for (std::size_t f = 0; f < n; ++f) particles.compression[f] += softness(f) * pressure_[f];
  last_ = {};
  at_release_ = false;
  options_ = options, dt_ = dt, constants_ = usual;
}

/// The films for the pressure found so far, and what happens without it but with them.
void ImplicitPressure::follow_films(std::span<const exchange::BodyState> states, Response& response,
                                    std::vector<SampleSums>& sums) {
  const auto put = [&](auto pressure) {
    for_blocks(items_->fluid_item.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) items_->record[items_->fluid_item[f]].p = pressure(f);
    });
  };
  put([&](std::size_t f) { return pressure_[f]; });
  gather_samples(*items_, *extras_, *constants_, sums);
  scale(sums);
  response.solve(*items_, *extras_, sums, *constants_, states, Scheme::kLeftOut, Films::kFollow);
  put([](std::size_t) { return 0.f; });
  without_pressure(states, response, sums);
}

/// Wave number of a quarter of a wave over the extent of the fluid along its gravity, or its largest, 1/m.
double ImplicitPressure::slowest_wave(const Particles& particles) const {
  const Vec3 lengths = extent_of(particles, items_->coordinates());
  const Vec3 gravity(constants_->gravity[0], constants_->gravity[1], constants_->gravity[2]);
  const double extent = weighs_ ? gravity.cwiseAbs().dot(lengths) / gravity.norm() : lengths.maxCoeff();
  return std::numbers::pi / (2 * std::max(extent, spacing_));
}

/// Largest eigenvalue of the fluid's part scaled by its diagonal, by power iteration from a rough start.
void ImplicitPressure::estimate_norm() {
  const std::size_t n = particles_->size();
  std::vector<float> x(n), y;
  for (std::size_t f = 0; f < n; ++f) x[f] = (f * 2654435761u >> 16 & 1) ? 1.f : -1.f;
  fluid_norm_ = 2;
  for (int k = 0; k < 20; ++k) {
    options_.sign_of_life();
    apply_pressure(*items_, *extras_, *constants_, pairs_, x, flow_, y);
    double xx = 0, yy = 0;
    for (std::size_t f = 0; f < n; ++f) {
      y[f] *= static_cast<float>(dt_ * dt_) / diagonal_[f];
      xx += static_cast<double>(x[f]) * x[f] * diagonal_[f], yy += static_cast<double>(y[f]) * y[f] * diagonal_[f];
    }
    const double norm = std::sqrt(yy / xx);
    fluid_norm_ = std::max(2.0, 1.1 * norm);
    for (std::size_t f = 0; f < n; ++f) x[f] = y[f] / static_cast<float>(norm);
  }
}

}  // namespace ballast::fluid
