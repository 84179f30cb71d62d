// Bound-constrained quadratic programs by MPRGP.
#include "fluid_server/pressure/mprgp.h"

#include <cmath>
#include <limits>

#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

struct Smallest {
  double of = std::numeric_limits<double>::infinity();
  void add(const Smallest& other) { of = std::min(of, other.of); }
};

}  // namespace

MprgpReport Mprgp::solve(QuadraticProgram& program, std::span<const float> diagonal, std::span<const float> b,
                         std::span<const std::uint8_t> bounded, std::vector<float>& x, double norm, int most_products,
                         int threads) {
  program_ = &program;
  diagonal_ = diagonal;
  b_ = b;
  bounded_ = bounded;
  x_ = &x;
  norm_ = norm;
  threads_ = threads;
  report_ = {};
  for (auto* v : {&gradient_, &projected_, &direction_, &product_, &preconditioned_}) v->resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (bounded_[i]) x[i] = std::max(x[i], 0.f);
  new_gradient();
  fresh_ = true;
  for (;;) {
    split();
    if (program.good(x, projected_)) {
      report_.converged = cut_off();
      if (report_.converged) break;
      new_gradient();
      fresh_ = true;
      continue;
    }
    if (report_.products >= most_products) break;
    report_.proportionings += release_;
    if (!step()) break;  // nothing left to gain in this precision
  }
  cut_off();
  return report_;
}

bool Mprgp::cut_off() {
  std::vector<float>&x = *x_, &cut = direction_;  // done with
  for_blocks(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      cut[i] = clamp(i, x[i]) - x[i];
      x[i] = clamp(i, x[i]);
    }
  });
  return program_->harmless(cut);
}

/// The gradient as far as x may follow it. Clamped entries take part in the next step if what they want to grow
/// outweighs what the free ones can still gain within their bounds, both in the metric of the diagonal.
void Mprgp::split() {
  const std::vector<float>& x = *x_;
  const double longest = 1.9 / norm_;
  const auto [clamped, slack] = sum_of<2>(x.size(), threads_, [&](std::size_t i, auto& sum) {
    const bool is_free = free(i);
    projected_[i] = is_free ? gradient_[i] : std::min(gradient_[i], 0.f);
    const double g = projected_[i], d = diagonal_[i];
    if (is_free)
      sum[1] += bounded_[i] ? std::min(g / d, x[i] / longest) * g : g * g / d;
    else
      sum[0] += g * g / d;
  });
  release_ = clamped > std::max(slack, 0.0);
}

/// The direction of the next step: down the gradient of what moves, and conjugate to the last one unless it starts
/// anew. What is at its bound, or beyond, stays.
void Mprgp::redirect() {
  const std::size_t n = x_->size();
  std::vector<float>& of_moving = projected_;  // done with until the next split
  for_blocks(n, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) of_moving[i] = moves(i) ? gradient_[i] : 0.f;
  });
  program_->precondition(of_moving, preconditioned_);
  const auto [along] = sum_of<1>(n, threads_, [&](std::size_t i, auto& sum) {
    preconditioned_[i] = moves(i) ? preconditioned_[i] : 0.f;
    sum[0] += static_cast<double>(preconditioned_[i]) * product_[i];
  });
  if (fresh_) {
    direction_ = preconditioned_;
    return;
  }
  const float keep = static_cast<float>(along / curvature_);
  for_blocks(n, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      direction_[i] = moves(i) ? preconditioned_[i] - keep * direction_[i] : 0.f;
  });
}

bool Mprgp::step() {
  const std::vector<float>& x = *x_;
  redirect();
  const bool down = fresh_;
  fresh_ = false;
  product(direction_, product_);
  const auto [curvature, slope] = sum_of<2>(x.size(), threads_, [&](std::size_t i, auto& sum) {
    const double d = direction_[i];
    sum[0] += d * product_[i];
    sum[1] += d * gradient_[i];
  });
  if (!(curvature > 0) || !(slope > 0)) {
    fresh_ = true;
    return !down;  // nothing is gained down the gradient either
  }
  curvature_ = curvature;
  const double alpha = slope / curvature;
  const float a = static_cast<float>(alpha);
  const auto [cut] = sum_of<1>(x.size(), threads_, [&](std::size_t i, auto& sum) {
    if (bounded_[i]) sum[0] += diagonal_[i] * std::max(a * direction_[i] - x[i], 0.f);
  });
  const bool meets_bound = cut > 0;
  report_.expansions += meets_bound;
  if (meets_bound && !program_->negligible(cut))
    expand(alpha);
  else
    subtract(alpha);
  return true;
}

void Mprgp::subtract(double alpha) {
  std::vector<float>& x = *x_;
  const float a = static_cast<float>(alpha);
  for_blocks(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      x[i] -= a * direction_[i];
      gradient_[i] -= a * product_[i];
    }
  });
}

/// The whole conjugate step, cut off at the bounds, is kept if it lowers the energy; cutting off pressures of a light
/// body leaves a force that may do anything. Else a step to the bound and a short one down the gradient, which always
/// does.
void Mprgp::expand(double alpha) {
  std::vector<float>& x = *x_;
  fresh_ = true;
  std::vector<float>&trial = projected_, &trial_gradient = preconditioned_;  // done with until the next split
  const float a = static_cast<float>(alpha);
  for_blocks(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) trial[i] = clamp(i, x[i] - a * direction_[i]);
  });
  product(trial, trial_gradient);
  const auto [change] = sum_of<1>(x.size(), threads_, [&](std::size_t i, auto& sum) {
    trial_gradient[i] -= b_[i];
    sum[0] += (static_cast<double>(trial[i]) - x[i]) * (static_cast<double>(trial_gradient[i]) + gradient_[i]);
  });
  if (change < 0) {
    std::swap(x, trial);
    std::swap(gradient_, trial_gradient);
    return;
  }
  ++report_.refused;
  subtract(std::min(alpha, longest_feasible()));
  const float shortened = static_cast<float>(1.9 / norm_);
  for_blocks(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      x[i] = clamp(i, free(i) ? x[i] - shortened * gradient_[i] / diagonal_[i] : x[i]);
  });
  new_gradient();
}

/// The longest step along the direction that no bound cuts off; none where an entry is beyond its own.
double Mprgp::longest_feasible() const {
  return fold<Smallest>(x_->size(), threads_,
                        [&](std::size_t i, Smallest& part) {
                          const double d = direction_[i];
                          if (d > 0 && bounded_[i]) part.of = std::min(part.of, std::max((*x_)[i], 0.f) / d);
                        })
      .of;
}

void Mprgp::new_gradient() {
  product(*x_, gradient_);
  for_blocks(gradient_.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) gradient_[i] -= b_[i];
  });
}

std::size_t Mprgp::memory() const {
  std::size_t floats = 0;
  for (const auto* v : {&gradient_, &projected_, &direction_, &product_, &preconditioned_}) floats += v->capacity();
  return floats * sizeof(float);
}

void Mprgp::product(std::span<const float> x, std::vector<float>& out) {
  ++report_.products;
  program_->multiply(x, out);
}

}  // namespace ballast::fluid
