// The incompressible pressure solve.
#include "fluid_server/pressure/implicit.h"

#include <chrono>
#include <cmath>

#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

constexpr float kNoise = 0.001f;     // compression that disorder alone may show
constexpr float kDisorder = 0.01f;   // of the summed density, which is not pulled at; what the start shows up to kLag
constexpr float kMostBias = 0.002f;  // of that sum, that is put down to disorder where a surface can sink
constexpr float kLag = 0.02f;        // by how much the compression may be below the summed density
constexpr float kGentle = 0.2f;      // share of that much compression that a step takes back
constexpr float kMost = 0.02f;       // beyond kNoise, that a step takes back
// Of the sound speed: the speed that the scene foretells. From there on corrections do not get faster.
constexpr double kFast = 0.1;
constexpr double kFullMove = 0.4;  // spacings at that speed, in a step that takes back in full
constexpr float kPull = 0.05f;     // of the compression to the summed density, per step, inside the fluid
constexpr float kSpray = 0.5f;     // fullness of what is spray
constexpr float kAjar = 0.3f;      // room from which on the summed density counts fully; from kShut on a little
constexpr float kWorst = 1e-2f;    // density error that a step may leave in any particle
constexpr double kGain = 1.5;      // by which a product lowers the error, at best but for easy systems
// By how much more than allowed the error may be that has been within it: residuals rise and fall, what is left to
// solve (in the energy of the system) only falls.
constexpr double kBounce = 1.3;
constexpr double kFelt = 0.5;     // of what a body's acceleration may change, that cut off pressures may change it by
constexpr double kLoosest = 0.1;  // change of a body's acceleration that any solve leaves, of max(|a|, reference)

/// The error of the density that a gradient stands for: its sum and the whole volume, m^3, and the largest as a share
/// of a particle's volume.
struct DensityError {
  double sum = 0, volume = 0;
  float worst = 0;
  void add(const DensityError& other) {
    sum += other.sum;
    volume += other.volume;
    worst = std::max(worst, other.worst);
  }
};

}  // namespace

/// The compression that a step takes back: what disorder makes gently, so that it does not become noise of the
/// pressure; what is beyond at once, but never faster than the flow: a particle that a heavy body presses onto the
/// floor would throw it off. In a short step less: what it moves particles by would otherwise be the same however
/// short, so that two particles that only huge pressures part get a speed, the speed a shorter step, and that more
/// speed.
float ImplicitPressure::source_of(float compression) const {
  return pace_ * (kGentle * std::min(compression, kNoise) + std::clamp(compression - kNoise, 0.f, kMost));
}

void ImplicitPressure::solve(Particles& particles, Neighbourhood& items, ItemExtras& extras,
                             const PassConstants& constants, std::span<const exchange::BodyState> states,
                             Response& response, std::vector<SampleSums>& sums, std::vector<float>& acceleration,
                             const ImplicitOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  particles_ = &particles, items_ = &items, extras_ = &extras, constants_ = &constants, options_ = options;
  acceleration_ = &acceleration;
  dt_ = constants.dt;
  const double pace = std::min(1.0, dt_ * kFast * constants.sound_speed / (kFullMove * spacing_));
  pace_ = static_cast<float>(pace * pace);
  const double gravity = std::hypot(constants.gravity[0], constants.gravity[1], constants.gravity[2]);
  const double foretold = kFast * constants.sound_speed;
  weighs_ = gravity > 0;
  // Where the fluid weighs nothing: what weighs on the bodies; without that, what stops the fastest flow in 100 d.
  reference_ = weighs_ ? gravity : options.weight > 0 ? options.weight : foretold * foretold / (100 * spacing_);
  const std::size_t n = particles.size();
  const int threads = constants.threads;

  // What happens without pressure in the fluid; samples keep the part of theirs that does not depend on it.
  pressure_.resize(n);
  for_blocks(n, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      pressure_[f] = particles.record[f].p;
      items.record[items.fluid_item[f]].p = 0;
    }
  });
  sum_rows(items, extras, constants, rows_, pairs_);
  find_shares();
  const bool first = untouched(particles);
  correct_compression(particles, first);
  if (first) release(particles, states, response, sums);
  without_pressure(states, response, sums);
  set_up(particles, states, response, sums);
  for_blocks(n, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const float borne = softness(f) * pressure_[f];
      source_[f] = borne + source_of(particles.compression[f] - borne);
    }
  });
  const MprgpReport solved = find_pressure(particles);
  // What the solve leaves of each particle's divergence becomes compression: nothing is forgotten.
  for_blocks(n, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const float volume = particles.record[f].volume;
      particles.compression[f] += softness(f) * pressure_[f] - source_[f] - left_[f] / volume;
      particles.record[f].p = items.record[items.fluid_item[f]].p = pressure_[f];
    }
  });
  ++report_.solves;
  report_.products += static_cast<std::uint64_t>(solved.products);
  report_.most = std::max(report_.most, static_cast<std::uint64_t>(solved.products));
  report_.expansions += static_cast<std::uint64_t>(solved.expansions);
  report_.refused += static_cast<std::uint64_t>(solved.refused);
  report_.unreached += !solved.converged;
  report_.worst_residual = std::max(report_.worst_residual, report_.residual);
  report_.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The system as set up, with the sources of compression in its right side; what it leaves into left_.
MprgpReport ImplicitPressure::find_pressure(const Particles& particles) {
  const std::size_t n = particles.size();
  const int threads = constants_->threads;
  for_blocks(n, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      right_[f] = particles.record[f].volume * source_[f] - static_cast<float>(dt_ * divergence_[f]);
  });
  for (const Held& held : held_) right_[held.particle] = held.right;
  balance_closed(particles);
  if (!bodies_.empty()) bodies_.factor(diagonal_);
  if (fluid_norm_ == 0) estimate_norm();
  history_.clear();
  reached_ = false;
  foreseen_ = start_;
  MprgpReport solved =
      mprgp_.solve(*this, diagonal_, right_, bounded_, pressure_, fluid_norm_ + (bodies_.empty() ? 0 : bodies_.norm()),
                   options_.most_products, threads);
  left_ = mprgp_.gradient();
  if (!bodies_.empty() && foreseen_now_ && correct_bodies()) {
    ++solved.products;
    left_ = scaled_;
  }
  return solved;
}

/// At the line where surface and wall meet, samples see the fluid move away along the wall, and the transposed
/// divergence would hand that to the particles as expansion: they would be drawn into the wall. What a sample
/// extrapolates therefore counts as far as the particles that it sees lie inside the fluid. Between solids there is no
/// air: what is pressed out of a closing gap must feel the pressure in it, or the last of it stays and bears the body.
void ImplicitPressure::find_shares() {
  constexpr float kOutside = 0.7f, kWithin = 0.85f;  // fullness of a particle that lies not at all, fully inside
  constexpr float kFew = 0.5f, kMany = 0.9f;         // share of such particles with which a sample counts not, fully
  constexpr float kTight = 0.2f, kOpen = 0.4f;       // room in a gap between solids, in one that water flows through
  const std::size_t n = particles_->size();
  std::vector<float>& inside = divergence_;  // not yet known
  inside.resize(n);
  for_blocks(n, constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const float full = (rows_[f].fullness - kOutside) / (kWithin - kOutside);
      const float shut = (kOpen - rows_[f].room) / (kOpen - kTight);
      inside[f] = std::clamp(std::max(full, shut), 0.f, 1.f);
    }
  });
  average_onto_samples(*items_, *constants_, pairs_, inside, share_);
  for_blocks(share_.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) share_[s] = std::clamp((share_[s] - kFew) / (kMany - kFew), 0.f, 1.f);
  });
}

/// A fluid without a surface cannot change its volume, and no pressure answers the mean of the right side but a uniform
/// one, which moves disordered particles a little: it would grow until it does (Taylor-Green vortices stood still after
/// two steps). Takes that mean away, and gives the uniform pressure a weight of its own, that of one particle. A piston
/// answers it.
void ImplicitPressure::balance_closed(const Particles& particles) {
  const std::size_t n = particles.size();
  const auto [right, volume, surface] = sum_of<3>(n, constants_->threads, [&](std::size_t f, auto& sum) {
    sum[0] += right_[f], sum[1] += particles.record[f].volume, sum[2] += bounded_[f];
  });
  uniform_ = 0;
  if (surface > 0 || !(volume > 0) || bodies_.has_piston()) return;
  uniform_ = mean_diagonal_;
  const float whole = static_cast<float>(right / volume);
  for_blocks(n, constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) right_[f] -= particles.record[f].volume * whole;
  });
}

void ImplicitPressure::scale(std::vector<SampleSums>& sums) const {
  for_blocks(sums.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) sums[s].share = share_[s];
  });
}

/// Compression follows the divergence, which keeps the volume but forgets positions. Inside the fluid it is pulled to
/// the summed density, less the mean excess that disorder gives every such sum, beyond what disorder alone shows:
/// pulled at that too, the particles of a relaxed start would push a cylinder with 15 % of its acceleration. Where
/// water with a surface weighs that mean is limited: a loss of volume looks the same, and hid in it. And the
/// compression is never far below the sum: a particle in a gap between solids may not hide what is around it. At a
/// surface the sum is short of neighbours, but never less than the truth when it is above.
/// In gaps too narrow for a particle the sum says nothing: a lone particle there counts as compressed however much room
/// it has, and would drive the solids apart.
/// What the start shows is disorder for certain, as its volume is exact, and more than that beside round bodies; it is
/// forgotten as particles pass each other.
void ImplicitPressure::correct_compression(Particles& particles, bool first) {
  // With short kernels the sum over what is packed evenly is off by more than disorder makes.
  const float even = std::abs(lattice_density_ - 1) > kDisorder ? 1 / lattice_density_ : 1.f;
  const auto [excess, inside] = sum_of<2>(particles.size(), constants_->threads, [&](std::size_t f, auto& sum) {
    if (rows_[f].fullness > kInside) sum[0] += even * rows_[f].delta - 1 - particles.compression[f], ++sum[1];
  });
  float bias = inside > 0 ? static_cast<float>(excess / inside) : 0.f;
  if (weighs_ && inside < static_cast<double>(particles.size())) bias = std::min(bias, kMostBias);
  if (first)
    start_disorder_ = fold<DensityError>(particles.size(), constants_->threads, [&](std::size_t f, DensityError& part) {
                        if (rows_[f].fullness > kInside)
                          part.worst = std::max(part.worst, std::abs(even * rows_[f].delta - 1 - bias));
                      }).worst;
  const float more = std::clamp(start_disorder_, kDisorder, kLag) - kDisorder;
  const float disorder = kDisorder + more * static_cast<float>(std::exp(-options_.way));
  for_blocks(particles.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      float& e = particles.compression[f];
      const float open = std::clamp((rows_[f].room - kShut) / (kAjar - kShut), 0.f, 1.f),
                  all = even * rows_[f].delta - 1;
      const float seen = open * all + (1 - open) * std::min(all, 0.f);
      if (rows_[f].fullness < kSpray) {
        e = seen;
      } else if (rows_[f].fullness > kInside) {
        const float off = seen - bias - e;
        e = std::max(e + kPull * (off - std::clamp(off, -disorder, disorder)), seen - bias - kLag);
      } else {
        e = std::max(e, seen);
      }
    }
  });
  const auto found = fold<DensityError>(particles.size(), constants_->threads, [&](std::size_t f, DensityError& part) {
    const float compressed = std::max(particles.compression[f], 0.f);
    part.sum += compressed;
    part.worst = std::max(part.worst, compressed);
  });
  report_.found_mean = found.sum / static_cast<double>(std::max<std::size_t>(particles.size(), 1));
  report_.found_max = found.worst;
}

void ImplicitPressure::multiply(std::span<const float> x, std::vector<float>& out) {
  options_.sign_of_life();
  const std::size_t n = x.size();
  apply_pressure(*items_, *extras_, *constants_, pairs_, x, flow_, out);
  const float dt2 = static_cast<float>(dt_ * dt_);
  for_blocks(n, constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) out[f] = dt2 * out[f] + yielding_[f] * x[f];
  });
  if (uniform_ > 0) {
    const auto [all] = sum_of<1>(n, constants_->threads, [&](std::size_t f, auto& sum) { sum[0] += x[f]; });
    const float push = static_cast<float>(uniform_ * all / static_cast<double>(n));
    for_blocks(n, constants_->threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) out[f] += push;
    });
  }
  if (bodies_.empty()) return;
  bodies_.reduce(x, reduced_);
  bodies_.spread(reduced_, out);
}

/// (D + U U^T)^-1 by Woodbury: D^-1 - D^-1 U (1 + U^T D^-1 U)^-1 U^T D^-1.
void ImplicitPressure::precondition(std::span<const float> r, std::vector<float>& out) {
  for_blocks(r.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) out[f] = r[f] / diagonal_[f];
  });
  if (bodies_.empty()) return;
  bodies_.reduce(out, reduced_);
  bodies_.solve(reduced_);
  bodies_.spread_scaled(reduced_, diagonal_, out);
}

bool ImplicitPressure::good(std::span<const float> x, std::span<const float> gradient) {
  const auto found = fold<DensityError>(x.size(), constants_->threads, [&](std::size_t f, DensityError& part) {
    const float size = std::abs(gradient[f]);
    part.worst = std::max(part.worst, size / particles_->record[f].volume);
    part.sum += size;
    part.volume += particles_->record[f].volume;
  });
  volume_ = found.volume;
  report_.residual = volume_ > 0 ? found.sum / volume_ : 0;
  const double error = std::max(report_.residual / options_.tolerance, static_cast<double>(found.worst / kWorst));
  reached_ |= error <= 1;
  if (bodies_.empty()) return reached_;
  // Bodies are looked at over the last products only: the density is seldom right sooner.
  foreseen_now_ = error <= std::pow(kGain, options_.body_products);
  if (!foreseen_now_) return false;
  foresee(x, gradient);
  history_.push_back(foreseen_);
  if (history_.size() > options_.body_products + 1) history_.pop_front();
  if (!reached_ || error > kBounce || history_.size() <= options_.body_products) return false;
  for (std::size_t b = 0; b < foreseen_.size(); ++b)
    if ((foreseen_[b] - history_.front()[b]).head<3>().norm() > allowed(b)) return false;
  return true;
}

/// True if bodies hardly feel what was cut off: by less than half of what their accelerations may still change.
bool ImplicitPressure::harmless(std::span<const float> cut) {
  if (bodies_.empty()) return true;
  bodies_.reduce(cut, reduced_);
  for (std::size_t b = 0; b < reduced_.size(); ++b)
    if (bodies_.motion(b, reduced_[b]).head<3>().norm() / dt_ > kFelt * allowed(b)) return false;
  return true;
}

/// By how much a body's acceleration may still change. In a short step more: what the density's tolerance does not see
/// either, but never more than the loosest class allows.
double ImplicitPressure::allowed(std::size_t body) const {
  const double size = std::max(foreseen_[body].head<3>().norm(), reference_);
  const double unseen = options_.tolerance * spacing_ / (dt_ * dt_);
  return std::max(options_.body_tolerance * size, std::min(unseen, kLoosest * size));
}

/// The accelerations of the bodies by these pressures, and by their correction. While a solve is under way a light
/// body's acceleration swings by several g: the smallest error of the force on it moves it. What it settles to shows
/// much sooner: with g the gradient, c = U^T D^-1 g and T = 1 + U^T D^-1 U the correction x -= D^-1 U T^-2 c moves the
/// bodies to where the fluid beside them would have them, and hardly moves heavy ones. Finds T^-2 c, and what it takes
/// from U^T x: T^-1 c - T^-2 c.
void ImplicitPressure::foresee(std::span<const float> x, std::span<const float> gradient) {
  scaled_.resize(gradient.size());
  for_blocks(gradient.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) scaled_[f] = gradient[f] / diagonal_[f];
  });
  bodies_.reduce(scaled_, gained_);
  bodies_.solve(gained_);
  correction_ = gained_;
  bodies_.solve(correction_);
  bodies_.reduce(x, reduced_);
  foreseen_.resize(reduced_.size());
  for (std::size_t b = 0; b < reduced_.size(); ++b) {
    gained_[b] -= correction_[b];
    foreseen_[b] = start_[b] + bodies_.motion(b, reduced_[b]) / dt_ - bodies_.motion(b, gained_[b]) / dt_;
  }
}

/// Makes the last correction found, if it moves a body by more than is allowed: true, with the gradient in `scaled_`.
bool ImplicitPressure::correct_bodies() {
  bool needed = false;
  for (std::size_t b = 0; b < gained_.size(); ++b)
    needed |= bodies_.motion(b, gained_[b]).head<3>().norm() / dt_ > allowed(b);
  if (!needed) return false;
  bodies_.spread_scaled(correction_, diagonal_, pressure_);
  for_blocks(pressure_.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f)
      if (bounded_[f]) pressure_[f] = std::max(pressure_[f], 0.f);
  });
  multiply(pressure_, scaled_);
  for_blocks(pressure_.size(), constants_->threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) scaled_[f] -= right_[f];
  });
  return true;
}

std::size_t ImplicitPressure::memory() const {
  std::size_t floats = 0;
  for (const auto* array :
       {&share_, &source_, &inverse_w_, &yielding_, &diagonal_, &right_, &pressure_, &divergence_, &scaled_, &last_})
    floats += array->capacity();
  return floats * sizeof(float) + mprgp_.memory() + pairs_.memory() + rows_.capacity() * sizeof(RowSums) +
         bounded_.capacity() + held_.capacity() * sizeof(Held) + flow_.capacity() * sizeof(Flow) + bodies_.memory();
}

}  // namespace ballast::fluid
