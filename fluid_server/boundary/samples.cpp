// Placing the boundary samples of all solids.
#include "fluid_server/boundary/samples.h"

#include <algorithm>
#include <array>
#include <map>

namespace ballast::fluid {

namespace {

/// Bounds in the body frame of a box given in the world frame.
Box3 in_body_frame(const Box3& box, const Pose& pose) {
  Box3 out{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 world((corner & 1 ? box.max : box.min)[0], (corner & 2 ? box.max : box.min)[1],
                     (corner & 4 ? box.max : box.min)[2]);
    const Vec3 local = pose.rotation.conjugate() * (world - pose.position);
    out.min = out.min.cwiseMin(local);
    out.max = out.max.cwiseMax(local);
  }
  return out;
}

Record place_one(const Vec3& position, const Vec3& velocity, float volume, const Coordinates& coordinates) {
  if (!coordinates.holds(position)) return Record{};
  const Fixed3 at = coordinates.to_fixed(position);
  return {at[0],
          at[1],
          at[2],
          0.f,
          static_cast<float>(velocity[0]),
          static_cast<float>(velocity[1]),
          static_cast<float>(velocity[2]),
          -volume};
}

/// Patches of about four spacings, one set per side of the body, so that a contact has one normal.
std::array<int, 5> patch_key(std::uint32_t body, const SurfaceSample& sample, double spacing) {
  Eigen::Index axis = 0;
  sample.normal.cwiseAbs().maxCoeff(&axis);
  const Vec3 cell = (sample.position / (4 * spacing)).array().floor();
  return {static_cast<int>(body), static_cast<int>(2 * axis) + (sample.normal[axis] > 0), static_cast<int>(cell[0]),
          static_cast<int>(cell[1]), static_cast<int>(cell[2])};
}

}  // namespace

Samples Samples::make(const Scene& scene, const std::vector<Body>& bodies, const Coordinates& coordinates,
                      double depth) {
  Samples s;
  std::map<std::array<int, 5>, std::uint32_t> patches;
  Box3 window = coordinates.domain;
  if (scene.world.dimension == 2) window.min[1] = -0.5, window.max[1] = 0.5;
  for (const bool moving : {false, true}) {
    if (moving) s.first_moving = static_cast<std::uint32_t>(s.size());
    for (std::uint32_t b = 0; b < bodies.size(); ++b) {
      if ((scene.models[b].motion != Motion::kStatic) != moving) continue;
      const Body& body = bodies[b];
      for (const SurfaceSample& one :
           body.solid.samples(scene.world.spacing, depth, in_body_frame(window, body.pose))) {
        const Vec3 world = body.pose.position + body.pose.rotation * one.position;
        if (!moving && !coordinates.holds(world)) continue;
        s.body.push_back(b);
        s.local.push_back(one.position.cast<float>());
        s.normal.push_back(one.normal.cast<float>());
        s.volume.push_back(static_cast<float>(one.volume));
        s.depth.push_back(static_cast<float>(one.depth));
        const auto [entry, fresh] = patches.try_emplace(patch_key(b, one, scene.world.spacing),
                                                        static_cast<std::uint32_t>(s.patch_body.size()));
        if (fresh) s.patch_body.push_back(b);
        s.patch.push_back(entry->second);
        s.record.push_back(place_one(world, Vec3::Zero(), s.volume.back(), coordinates));
      }
    }
  }
  // They are as many for the whole run: no room for more.
  const auto trim = [](auto&... arrays) { (arrays.shrink_to_fit(), ...); };
  trim(s.body, s.local, s.normal, s.volume, s.depth, s.patch, s.record, s.patch_body);
  s.first.assign(bodies.size() + 1, 0);
  for (std::uint32_t b : s.body) ++s.first[b + 1];
  for (std::size_t b = 1; b < s.first.size(); ++b) s.first[b] += s.first[b - 1];
  s.order.resize(s.size());
  std::vector<std::uint32_t> cursor(s.first.begin(), s.first.end() - 1);
  for (std::uint32_t k = 0; k < s.size(); ++k) s.order[cursor[s.body[k]]++] = k;
  return s;
}

void Samples::place(std::span<const exchange::BodyState> states, const Coordinates& coordinates, int threads) {
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::size_t k = first_moving; k < size(); ++k) {
    const exchange::BodyState& state = states[body[k]];
    const Quat q = rotation_of(state);
    const Vec3 arm = q * local[k].cast<double>();
    const Vec3 velocity = Vec3::Map(state.velocity) + Vec3::Map(state.angular_velocity).cross(arm);
    record[k] = place_one(Vec3::Map(state.position) + arm, velocity, volume[k], coordinates);
  }
}

exchange::BodyState initial_state(const Model& model, const Body& body, const Vec3& gravity) {
  exchange::BodyState state{};
  Vec3::Map(state.position) = body.pose.position;
  const Quat& q = body.pose.rotation;
  state.orientation[0] = q.w(), state.orientation[1] = q.x(), state.orientation[2] = q.y(),
  state.orientation[3] = q.z();
  if (model.motion == Motion::kDynamic) {
    Vec3::Map(state.velocity) = model.velocity;
    Vec3::Map(state.angular_velocity) = model.angular_velocity;
    Vec3::Map(state.free_acceleration) = gravity;
  }
  return state;
}

}  // namespace ballast::fluid
