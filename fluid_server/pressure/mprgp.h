// Bound-constrained quadratic programs by MPRGP (modified proportioning with reduced gradient projections, Dostal and
// Schoeberl 2005): minimise x.A x / 2 - b.x with x >= 0 for the entries that are bounded, A symmetric positive
// semidefinite and known by its products. Conjugate gradients on the entries that are free (x > 0), joined by those of
// the clamped that want to grow when their gradient dominates (proportioning); expansion when a step would leave the
// bounds by more than is negligible. What is left of them by less is cut off at the end only:
// cut off on the way, it would cost a gradient of its own every time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace ballast::fluid {

/// What MPRGP must know of the problem.
class QuadraticProgram {
 public:
  virtual ~QuadraticProgram() = default;
  /// out = A x.
  virtual void multiply(std::span<const float> x, std::vector<float>& out) = 0;
  /// out = (approximate inverse of A) r, symmetric positive definite.
  virtual void precondition(std::span<const float> r, std::vector<float>& out) = 0;
  /// True if an error of this size, the sum of A_ii times how far entries are beyond their bounds, does not matter
  /// beside what good() asks for.
  virtual bool negligible(double beyond) const = 0;
  /// True if what is cut off at the end, `cut` >= 0 of every entry, does not matter either.
  virtual bool harmless(std::span<const float> cut) = 0;
  /// True if x is good enough. `gradient` is that of the free entries, and the negative part of that of the clamped
  /// ones: zero at the solution.
  virtual bool good(std::span<const float> x, std::span<const float> gradient) = 0;
};

struct MprgpReport {
  int products = 0;        ///< of A with a vector: the cost
  int expansions = 0;      ///< steps that met a bound
  int refused = 0;         ///< projected steps that would have raised the energy: a short one was taken
  int proportionings = 0;  ///< steps in which clamped entries took part
  bool converged = false;
};

class Mprgp {
 public:
  /// `bounded` marks the entries that must not be negative. `diagonal` > 0 scales the entries: an approximation of A's.
  /// x holds the start (negative entries are clamped) and the result. `norm` bounds the largest eigenvalue of A scaled
  /// by the diagonal and sets the length of the short steps.
  MprgpReport solve(QuadraticProgram& program, std::span<const float> diagonal, std::span<const float> b,
                    std::span<const std::uint8_t> bounded, std::vector<float>& x, double norm, int most_products,
                    int threads);
  /// A x - b at the result, before what does not matter was cut off.
  std::span<const float> gradient() const { return gradient_; }
  std::size_t memory() const;  ///< bytes of its arrays

 private:
  bool free(std::size_t i) const { return (*x_)[i] > 0 || !bounded_[i]; }
  bool moves(std::size_t i) const { return free(i) || (release_ && gradient_[i] < 0); }
  float clamp(std::size_t i, float value) const { return bounded_[i] ? std::max(value, 0.f) : value; }
  bool cut_off();   ///< x to its bounds; false if that matters
  void split();     ///< gradient_ -> projected_, release_
  void redirect();  ///< direction_
  bool step();      ///< conjugate gradients, or expansion
  void expand(double alpha);
  double longest_feasible() const;
  void subtract(double alpha);  ///< x -= alpha direction, gradient -= alpha A direction
  void new_gradient();          ///< from scratch: no rounding of many updates stays
  void product(std::span<const float> x, std::vector<float>& out);

  QuadraticProgram* program_ = nullptr;
  std::span<const float> diagonal_, b_;
  std::span<const std::uint8_t> bounded_;
  std::vector<float>* x_ = nullptr;
  double norm_ = 0;
  double curvature_ = 0;  // direction . A direction of the last step
  int threads_ = 1;
  bool fresh_ = true;     // the direction is to start anew
  bool release_ = false;  // clamped entries that want to grow take part in the step
  MprgpReport report_;
  std::vector<float> gradient_, projected_, direction_, product_, preconditioned_;
};

}  // namespace ballast::fluid
