// Bound-constrained quadratic programs by MPRGP.
#include "fluid_server/pressure/mprgp.h"

#include <cmath>
#include <limits>

#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

/// Of a direction d with product A d: d.A d, gradient.d, and the longest step along it that no bound cuts off.
struct Course {
  double curvature = 0, slope = 0, feasible = std::numeric_limits<double>::infinity();
  void add(const Course& other) {
    curvature += other.curvature;
    slope += other.slope;
    feasible = std::min(feasible, other.feasible);
  }
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
  for (auto* v : {&gradient_, &projected_, &direction_, &product_, &preconditioned_, &trial_, &trial_gradient_})
    v->resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    if (bounded_[i]) x[i] = std::max(x[i], 0.f);
  new_gradient();
  fresh_ = true;
  for (;;) {
    split();
    if (program.good(x, projected_)) {
      report_.converged = !stale_;
      if (!stale_) break;
      new_gradient();
      fresh_ = true;
      continue;
    }
    if (report_.products >= most_products) break;
    report_.proportionings += release_;
    if (!step()) break;  // nothing left to gain in this precision
  }
  return report_;
}

/// The gradient as far as x may follow it. Clamped entries take part in the next step if what they want to grow
/// outweighs what the free ones can still gain within their bounds, both in the metric of the diagonal.
void Mprgp::split() {
  const std::vector<float>& x = *x_;
  const double longest = 1.9 / norm_;
  const auto [clamped, slack] = sum_blocks<2>(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    double c = 0, f = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const bool is_free = free(i);
      projected_[i] = is_free ? gradient_[i] : std::min(gradient_[i], 0.f);
      const double g = projected_[i], d = diagonal_[i];
      if (is_free)
        f += bounded_[i] ? std::min(g / d, x[i] / longest) * g : g * g / d;
      else
        c += g * g / d;
    }
    return std::array<double, 2>{c, f};
  });
  release_ = clamped > std::max(slack, 0.0);
}

/// The direction of the next step: down the gradient of what moves, and conjugate to the last one unless it starts
/// anew.
void Mprgp::redirect() {
  const std::size_t n = x_->size();
  for_blocks(n, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) trial_[i] = moves(i) ? gradient_[i] : 0.f;
  });
  program_->precondition(trial_, preconditioned_);
  const auto [along] = sum_blocks<1>(n, threads_, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      preconditioned_[i] = moves(i) ? preconditioned_[i] : 0.f;
      sum += static_cast<double>(preconditioned_[i]) * product_[i];
    }
    return std::array<double, 1>{sum};
  });
  if (fresh_) {
    direction_ = preconditioned_;
    return;
  }
  const float keep = static_cast<float>(along / curvature_);
  for_blocks(n, threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) direction_[i] = preconditioned_[i] - keep * direction_[i];
  });
}

bool Mprgp::step() {
  const std::vector<float>& x = *x_;
  redirect();
  const bool down = fresh_;
  fresh_ = false;
  product(direction_, product_);
  const Course course = fold_blocks<Course>(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    Course part;
    for (std::size_t i = begin; i < end; ++i) {
      const double d = direction_[i];
      part.curvature += d * product_[i];
      part.slope += d * gradient_[i];
      if (d > 0 && bounded_[i]) part.feasible = std::min(part.feasible, x[i] / d);
    }
    return part;
  });
  if (!(course.curvature > 0) || !(course.slope > 0)) {
    fresh_ = true;
    return !down;  // nothing is gained down the gradient either
  }
  curvature_ = course.curvature;
  const double alpha = course.slope / course.curvature;
  if (alpha <= course.feasible) {
    subtract(alpha);
    return true;
  }
  const float a = static_cast<float>(alpha);
  const auto [cut] = sum_blocks<1>(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i)
      if (bounded_[i]) sum += diagonal_[i] * std::max(a * direction_[i] - x[i], 0.f);
    return std::array<double, 1>{sum};
  });
  if (program_->negligible(cut)) {
    ++report_.expansions;
    subtract(alpha);
    stale_ = true;
  } else {
    expand(alpha, course.feasible);
  }
  return true;
}

void Mprgp::subtract(double alpha) {
  std::vector<float>& x = *x_;
  const float a = static_cast<float>(alpha);
  for_blocks(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      x[i] = clamp(i, x[i] - a * direction_[i]);
      gradient_[i] -= a * product_[i];
    }
  });
}

/// The whole conjugate step, cut off at the bounds, is kept if it lowers the energy; cutting off pressures of a light
/// body leaves a force that may do anything. Else a step to the bound and a short one down the gradient, which always
/// does.
void Mprgp::expand(double alpha, double feasible) {
  std::vector<float>& x = *x_;
  ++report_.expansions;
  fresh_ = true;
  const float a = static_cast<float>(alpha);
  for_blocks(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) trial_[i] = clamp(i, x[i] - a * direction_[i]);
  });
  product(trial_, trial_gradient_);
  const auto [change] = sum_blocks<1>(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      trial_gradient_[i] -= b_[i];
      sum += (static_cast<double>(trial_[i]) - x[i]) * (static_cast<double>(trial_gradient_[i]) + gradient_[i]);
    }
    return std::array<double, 1>{sum};
  });
  if (change < 0) {
    stale_ = false;
    std::swap(x, trial_);
    std::swap(gradient_, trial_gradient_);
    return;
  }
  ++report_.refused;
  subtract(feasible);
  const float shortened = static_cast<float>(1.9 / norm_);
  for_blocks(x.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (free(i)) x[i] = clamp(i, x[i] - shortened * gradient_[i] / diagonal_[i]);
  });
  new_gradient();
}

void Mprgp::new_gradient() {
  stale_ = false;
  product(*x_, gradient_);
  for_blocks(gradient_.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) gradient_[i] -= b_[i];
  });
}

void Mprgp::product(std::span<const float> x, std::vector<float>& out) {
  ++report_.products;
  program_->multiply(x, out);
}

}  // namespace ballast::fluid
