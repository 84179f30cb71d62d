// The pressure of an incompressible fluid at the moment of release, so that a run does not begin with a sound wave.
//
// A hydrostatic start is wrong wherever something gives way at t = 0: a body released under water, a dam that is
// suddenly gone. A compressible fluid answers with waves that hide the first accelerations. The pressure sought makes
// the acceleration free of divergence, D a(p) = 0, bodies included. With positions frozen and accelerations in the
// place of velocities, p'' = -rho c^2 D a(p) is the fluid's own wave equation: damped critically at its slowest wave
// (heavy ball, Polyak 1964) it comes to rest at that pressure.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fluid_server/particles/extent.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

namespace {

constexpr int kMostRounds = 3000;
constexpr double kCourant = 0.6;     // of h / c, as in time
constexpr double kConverged = 1e-4;  // largest change of pressure in a round over the largest pressure

}  // namespace

QuietReport WcsphFluid::quiet_start(std::span<const exchange::BodyState> states) {
  QuietReport report;
  if (implicit_) return report;  // finds that pressure in its first step
  const auto moving = [](const Record& r) { return r.vx != 0 || r.vy != 0 || r.vz != 0; };
  samples_->place(states, coordinates_, constants_.threads);
  if (!particles_.at_rest() || std::any_of(samples_->record.begin(), samples_->record.end(), moving))
    return report;  // what is in motion has its own pressure field, which the release does not decide
  std::swap(particles_, before_);
  items_->rebuild(before_, particles_, samples_->moving(), samples_->first_moving);
  prepare_extras();
  PassConstants frozen = constants_;
  frozen.viscous = false;
  frozen.ram_on_samples = false;
  frozen.diffusion = 0;
  build_lists(*items_, frozen);
  const double tau = kCourant * frozen.kernel.h() / frozen.sound_speed;
  const double slowest = frozen.sound_speed * std::numbers::pi / (2 * extent_of(particles_, coordinates_).maxCoeff());
  const float keep = static_cast<float>(std::max(0.0, 1 - 2 * slowest * tau));
  frozen.dt = static_cast<float>(tau * tau);
  std::vector<float> last(particles_.size());
  for (std::size_t f = 0; f < last.size(); ++f) last[f] = particles_.record[f].p;
  for (report.rounds = 1; report.rounds <= kMostRounds; ++report.rounds) {
    sign_of_life_();
    gather_samples(*items_, extras_, frozen, sums_);
    response_->solve(*items_, extras_, sums_, frozen, states, scheme_, Films::kFollow);
    accelerate(*items_, extras_, frozen, acceleration_);
    put_accelerations_for_velocities();
    advance_pressure(*items_, extras_, frozen, pressure_);
    double change = 0, largest = 0;
#pragma omp parallel for num_threads(frozen.threads) schedule(static) reduction(max : change, largest)
    for (std::size_t f = 0; f < last.size(); ++f) {
      Record& item = items_->record[items_->fluid_item[f]];
      const float next = pressure_[f] + keep * (item.p - last[f]);
      change = std::max(change, static_cast<double>(std::abs(next - item.p)));
      largest = std::max(largest, static_cast<double>(std::abs(next)));
      last[f] = item.p;
      item.p = particles_.record[f].p = next;
      item.vx = item.vy = item.vz = 0;
    }
    for (std::uint32_t s : items_->sample_item) items_->record[s].vx = items_->record[s].vy = items_->record[s].vz = 0;
    report.change = largest > 0 ? change / largest : 0;
    if (report.change < kConverged) break;
  }
  return report;
}

void WcsphFluid::put_accelerations_for_velocities() {
#pragma omp parallel for num_threads(constants_.threads) schedule(static)
  for (std::size_t f = 0; f < particles_.size(); ++f) {
    Record& item = items_->record[items_->fluid_item[f]];
    item.vx = acceleration_[3 * f], item.vy = acceleration_[3 * f + 1], item.vz = acceleration_[3 * f + 2];
  }
#pragma omp parallel for num_threads(constants_.threads) schedule(static)
  for (std::size_t s = 0; s < items_->sample_item.size(); ++s) {
    Record& item = items_->record[items_->sample_item[s]];
    const Vec3 a = response_->acceleration_of(items_->source[items_->sample_item[s]] & ~Neighbourhood::kSample);
    item.vx = static_cast<float>(a[0]), item.vy = static_cast<float>(a[1]), item.vz = static_cast<float>(a[2]);
  }
}

}  // namespace ballast::fluid
