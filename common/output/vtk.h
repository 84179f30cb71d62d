// ParaView files: one .vtp of particles and one of body surfaces per output time, and a .pvd index of each series.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "common/geometry/bodies.h"
#include "common/output/particles.h"
#include "common/result.h"

namespace ballast::output {

/// XML PolyData file of the particles as vertices with velocity, pressure and density. Written whole or not at all.
Status write_particles_vtp(const std::string& path, const ParticleFrame& particles);

/// XML PolyData file of the surfaces of all bodies at `poses` (one per body, body frames), cell data "body" = index.
Status write_bodies_vtp(const std::string& path, const std::vector<Body>& bodies, std::span<const Pose> poses);

/// A growing time series in `folder` (made if missing): particles_00000.vtp ..., particles.pvd, bodies_00000.vtp ...,
/// bodies.pvd. The indexes are complete after every add(), so that a run can be looked at while it goes on.
class VtkSeries {
 public:
  explicit VtkSeries(std::string folder);
  /// Adds one output time. Without particles (empty spans) only bodies are written.
  /// For checkpoints: the series goes on after the times that it has.
  template <class A>
  void state(A& a) {
    a("times", times_), a("any_particles", any_particles_);
  }
  Status add(double time, const ParticleFrame& particles, const std::vector<Body>& bodies, std::span<const Pose> poses);

 private:
  std::string folder_;
  std::vector<double> times_;
  bool any_particles_ = false;
};

}  // namespace ballast::output
