// All solids' boundary samples in one set with a body index: static bodies first, then those that can move.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "common/exchange/records.h"
#include "common/geometry/bodies.h"
#include "fluid_server/particles/coordinates.h"
#include "fluid_server/particles/particles.h"

namespace ballast::fluid {

/// Forces and torques, accelerations and angular accelerations of a body, one behind the other.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

struct Samples {
  // per sample
  std::vector<std::uint32_t> body;      ///< index in scene.models
  std::vector<Eigen::Vector3f> local;   ///< m, body frame
  std::vector<Eigen::Vector3f> normal;  ///< unit, out of the solid, body frame
  std::vector<float> volume;            ///< m^3
  std::vector<float> depth;             ///< m below the surface
  std::vector<std::uint32_t> patch;     ///< contact patch, index into patch_body
  std::vector<Record> record;           ///< in the world, for the neighbourhood; volume negative, 0 outside the domain
  std::uint32_t first_moving = 0;
  // per body: its samples are [first[b], first[b + 1]) in the order of `order`
  std::vector<std::uint32_t> first, order;
  std::vector<std::uint32_t> patch_body;

  /// Fills every solid to `depth` below its surface.
  static Samples make(const Scene& scene, const std::vector<Body>& bodies, const Coordinates& coordinates,
                      double depth);

  std::size_t size() const { return body.size(); }
  std::size_t memory() const;  ///< bytes of all its arrays
  std::span<const Record> fixed() const { return {record.data(), first_moving}; }
  std::span<const Record> moving() const { return {record.data() + first_moving, size() - first_moving}; }

  /// Puts the moving samples where the bodies are.
  void place(std::span<const exchange::BodyState> states, const Coordinates& coordinates, int threads);
};

/// Rotation of the body frame against the world.
inline Quat rotation_of(const exchange::BodyState& state) {
  return {state.orientation[0], state.orientation[1], state.orientation[2], state.orientation[3]};
}

/// Change of its twist per impulse wrench (linear, angular).
inline auto mobility_of(const exchange::BodyState& state) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(state.mobility);
}

/// State of a body at t = 0.
exchange::BodyState initial_state(const Model& model, const Body& body, const Vec3& gravity);

}  // namespace ballast::fluid
