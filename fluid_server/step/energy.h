// The energy of the fluid against what it may have. It starts with some, gives work to the bodies that it moves, takes
// work from those that move it, and loses the rest to viscosity and impacts; it never gains any by itself. What it has
// gained is an error of the steps.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/geometry/bodies.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

inline constexpr double kEnergyWarning = 0.01;  ///< share of the energy at play above which a run warns

class EnergyBalance {
 public:
  EnergyBalance(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid);

  /// Why there is no balance; empty: there is one.
  const std::string& left_out() const { return left_out_; }

  /// The run begins with this state, which `now` was measured in.
  void start(const Measures& now);
  /// Books the work on bodies in a step of length dt, s, from `before` to `after`.
  void step(std::span<const exchange::BodyState> before, std::span<const exchange::BodyState> after, double dt);
  /// Gravity was changed from outside, which took the energy of the state as it is from `before` to `after`.
  void jump(const Measures& before, const Measures& after);
  /// Compares.
  void measure(const Measures& now);

  double gain() const { return gain_; }  ///< energy gained by the fluid since the start, as measured last, J
  /// Energy at play, J: what gravity could release from the fluid at the start, and the most of kinetic and elastic
  /// energy and of work on bodies that there has been.
  double reference() const;
  double share() const { return share_; }    ///< largest gain over reference so far; 0: none
  double share_now() const { return now_; }  ///< of the last measurement, negative: lost
  double work() const { return work_; }      ///< on bodies, J

  /// For checkpoints.
  template <class A>
  void state(A& a) {
    a("begin", begin_), a("head", head_), a("least", least_), a("work", work_), a("most_work", most_work_);
    a("most_kinetic", most_kinetic_), a("most_elastic", most_elastic_), a("gain", gain_), a("now", now_);
    a("share", share_);
  }

 private:
  const Scene& scene_;
  const WcsphFluid& fluid_;
  std::string left_out_;
  std::vector<Vec3> buoyancy_;  // N, of numerics.reduced_gravity: nobody has its potential energy in a sum
  double begin_ = 0, head_ = 0, least_ = 0, work_ = 0;
  double most_work_ = 0, most_kinetic_ = 0, most_elastic_ = 0;
  double gain_ = 0, now_ = 0, share_ = 0;
};

}  // namespace ballast::fluid
