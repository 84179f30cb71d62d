// Keeps the centres of particles out of solids where pressure alone does not: a particle squeezed between two solids,
// or drawn along a wall at the edge of a surface, has samples all around it and no gradient that would drive it out. An
// inelastic contact between particle and solid, action equal to reaction; in ordinary flow, half a spacing off the
// wall, it does nothing.
#pragma once
#include <span>
#include <vector>

#include "common/geometry/bodies.h"
#include "fluid_server/boundary/response.h"

namespace ballast::fluid {

/// What the barrier did, for the record.
struct BarrierReport {
  std::uint64_t pushes = 0;  ///< particles held, summed over steps
  double impulse = 0;        ///< sum of magnitudes, N s
  double deepest = 0;        ///< of a particle's centre below a surface, m
};

class Barrier {
 public:
  /// `bodies` must outlive this. `brakes`: particles are stopped over many steps, not in one (short ones).
  Barrier(const Samples& samples, std::span<const Body> bodies, double spacing, bool brakes);

  /// Velocity that a particle gains at the end of the step, m/s.
  struct Push {
    std::uint32_t particle;
    Eigen::Vector3f gain;
  };

  /// With the pressures of the step in items.record: finds particles whose velocity after the step would bring them
  /// below a surface and holds them there; those that are below come out by a fifth of their depth. Adds the reaction
  /// to the wrenches of `response`. Projected Gauss-Seidel over all contacts in a fixed order, with the bodies'
  /// mobility in the water around them: a particle between two solids stops both.
  void solve(Neighbourhood& items, const ItemExtras& extras, const std::vector<SampleSums>& sums,
             const PassConstants& constants, std::span<const exchange::BodyState> states, Response& response);

  std::span<const Push> pushes() const { return pushes_; }
  const BarrierReport& report() const { return report_; }
  void put_back(const BarrierReport& report) { report_ = report; }
  template <class A>
  void state(A& a) {
    a("report", report_);
  }
  std::size_t memory() const { return contacts_.capacity() * sizeof(Contact) + pushes_.capacity() * sizeof(Push); }

 private:
  struct Near {
    std::uint32_t particle, body, sample;
    float distance2;  // of the sample
  };
  struct Contact {
    std::uint32_t particle = 0, body = 0, sample = 0;
    std::uint32_t slot = 0;                          // into pushes_
    Vec3 normal = Vec3::Zero(), arm = Vec3::Zero();  // out of the solid; from its centre of mass
    double height = 0;                               // of the particle above the surface
    bool meets = false;                              // in this step
    double least = 0;                                // velocity of separation, at least
    double impulse = 0;
    double mass = 0, inverse_mass = 0;  // of the particle; effective, of both
  };
  void find_near(const Neighbourhood& items, const PassConstants& constants, const std::vector<SampleSums>& sums);
  void find_touching(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                     std::span<const exchange::BodyState> states, const Response& response);
  void keep_touching();
  void share_out(bool still);

  const Samples& samples_;
  std::span<const Body> bodies_;
  double spacing_;
  bool brakes_;
  std::vector<std::vector<Near>> near_;  // by block of samples
  std::vector<Contact> contacts_;
  std::vector<Push> pushes_;
  std::vector<std::uint32_t> particles_;               // of pushes_
  std::vector<float> acceleration_;                    // of them
  std::vector<Eigen::Matrix<double, 6, 1>> motion_;    // gained by bodies
  std::vector<Eigen::Matrix<double, 6, 6>> mobility_;  // of those in contact
  BarrierReport report_;
};

}  // namespace ballast::fluid
