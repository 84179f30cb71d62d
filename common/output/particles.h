// Particles as the writers of files and pictures see them: plain spans, world frame, SI.
#pragma once
#include <span>

namespace ballast::output {

/// Views of the fluid's particles; the vectors are x y z per particle. Pressure and density may be empty: then left
/// out.
struct ParticleFrame {
  std::span<const float> position;  ///< m, 3 per particle
  std::span<const float> velocity;  ///< m/s, 3 per particle
  std::span<const float> pressure;  ///< Pa
  std::span<const float> density;   ///< kg/m^3
};

}  // namespace ballast::output
