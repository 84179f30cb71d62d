// Particle shifting: where no weight presses the particles of a fluid together, shear tears their lattice, and what is
// torn takes energy from the flow. Every step moves them a little towards even distances (Lind et al., J. Comput. Phys.
// 231 (2012) 1499-1523), in proportion to the shear that disorders them: nothing at rest, and the same in any frame.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "fluid_server/passes/passes.h"

namespace ballast::fluid {

/// Sums over the run, for the record.
struct ShiftReport {
  std::uint64_t steps = 0;
  double mean = 0;     ///< of a particle in a step, sum over steps, spacings
  double largest = 0;  ///< of any particle in any step, spacings
};

class Shifting {
 public:
  /// `held`: walls or other solids that do not move freely are in the scene, or the domain repeats itself.
  Shifting(double spacing, bool held) : spacing_(spacing), held_(held) {}

  /// Lists and records are those of the step. Finds the moves, and by how much they spread the fluid out: pressure
  /// follows the velocities, so that what shifting undoes would pile up as pressure. Their mean is given back:
  /// `expansion`, the share of its density that the fluid loses. Where no solid is near
  /// or all of them are free, the centre of mass stays where it is, and the angular momentum what it is.
  void find(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants);
  /// Move of a particle, m.
  Eigen::Vector3f move(std::size_t particle) const { return Eigen::Vector3f::Map(uneven_[particle].push); }
  float expansion() const { return expansion_; }

  const ShiftReport& report() const { return report_; }
  void put_back(const ShiftReport& report) { report_ = report; }
  std::size_t memory() const { return uneven_.capacity() * sizeof(Unevenness); }
  template <class A>
  void state(A& a) {
    a("report", report_);
  }

 private:
  /// Means over what may move.
  struct Frame {
    Vec3 move = Vec3::Zero();      // m
    Vec3 velocity = Vec3::Zero();  // m/s
  };
  void limit_moves(const PassConstants& constants);
  Frame find_frame(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants) const;
  Vec3 find_turn(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                 const Frame& frame) const;

  double spacing_;
  bool held_;
  std::vector<Unevenness> uneven_;  // `push` becomes the move
  float expansion_ = 0;
  ShiftReport report_;
};

}  // namespace ballast::fluid
