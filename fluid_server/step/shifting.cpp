// Particle shifting.
#include "fluid_server/step/shifting.h"

#include <algorithm>

#include "fluid_server/pressure/sums.h"

namespace ballast::fluid {

namespace {

constexpr float kStrength = 20;     // move = strength h dt (speed of a neighbour) push; figures: README.md
constexpr float kOvershoot = 1;     // d^2: a longer move for the same push passes the even place
constexpr float kFarthest = 0.05f;  // d, in a step
constexpr float kSurface = 0.92f, kInside = 0.96f;  // fullness of a particle that is not moved, that is
constexpr float kSolid = 0.02f;  // share of solids in its surroundings that keeps a particle where it is

Vec3 velocity(const Record& r) { return {r.vx, r.vy, r.vz}; }

/// How far particles move, m, and by how much all of them expand, m^3.
struct Moved {
  double dense = 0, all = 0, volume = 0;
  float longest = 0;
  void add(const Moved& other) {
    dense += other.dense, all += other.all, volume += other.volume;
    longest = std::max(longest, other.longest);
  }
};

}  // namespace

/// Pushes become moves.
void Shifting::limit_moves(const PassConstants& constants) {
  const float d = static_cast<float>(spacing_),
              rate = kStrength * static_cast<float>(constants.kernel.h()) * constants.dt;
  for_blocks(uneven_.size(), constants.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      Unevenness& u = uneven_[f];
      u.share = std::clamp((u.fullness - kSurface) / (kInside - kSurface), 0.f, 1.f) *
                std::clamp(1 - u.solid / kSolid, 0.f, 1.f);
      auto move = Eigen::Vector3f::Map(u.push);
      move *= u.share * std::min(rate * u.speed, kOvershoot * d * d);
      if (const float length = move.norm(); length > kFarthest * d) move *= kFarthest * d / length;
    }
  });
}

/// Mean move and mean velocity, weighted by how much a particle may move.
Shifting::Frame Shifting::find_frame(const Neighbourhood& items, const ItemExtras& extras,
                                     const PassConstants& constants) const {
  const auto sums = sum_of<7>(uneven_.size(), constants.threads, [&](std::size_t f, auto& sum) {
    const Unevenness& u = uneven_[f];
    const std::uint32_t item = items.fluid_item[f];
    const double mass = static_cast<double>(extras.density_of(item)) * items.record[item].volume;
    Vec3::Map(&sum[0]) += mass * Eigen::Vector3f::Map(u.push).cast<double>();
    Vec3::Map(&sum[3]) += mass * u.share * velocity(items.record[item]);
    sum[6] += mass * u.share;
  });
  if (sums[6] <= 0) return {};
  return {Vec3::Map(&sums[0]) / sums[6], Vec3::Map(&sums[3]) / sums[6]};
}

/// Moves m of particles of momentum p change the angular momentum by the sum of m x p. Taking share (move + (v -
/// velocity) x turn) from each keeps it, and the centre of mass, whatever the origin and the frame.
Vec3 Shifting::find_turn(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants,
                         const Frame& frame) const {
  const auto sums = sum_of<9>(uneven_.size(), constants.threads, [&](std::size_t f, auto& sum) {
    const Unevenness& u = uneven_[f];
    const std::uint32_t item = items.fluid_item[f];
    const double mass = static_cast<double>(extras.density_of(item)) * items.record[item].volume;
    const Vec3 v = velocity(items.record[item]) - frame.velocity;
    const Vec3 move = Eigen::Vector3f::Map(u.push).cast<double>() - u.share * frame.move;
    Vec3::Map(&sum[0]) += mass * move.cross(v);
    // |v|^2 I - v v^T, its upper triangle
    const double w = mass * u.share;
    sum[3] += w * (v[1] * v[1] + v[2] * v[2]), sum[4] += w * (v[0] * v[0] + v[2] * v[2]);
    sum[5] += w * (v[0] * v[0] + v[1] * v[1]);
    sum[6] -= w * v[0] * v[1], sum[7] -= w * v[0] * v[2], sum[8] -= w * v[1] * v[2];
  });
  Eigen::Matrix3d a;
  a << sums[3], sums[6], sums[7], sums[6], sums[4], sums[8], sums[7], sums[8], sums[5];
  return a.completeOrthogonalDecomposition().solve(Vec3::Map(&sums[0]));
}

void Shifting::find(const Neighbourhood& items, const ItemExtras& extras, const PassConstants& constants) {
  find_unevenness(items, constants, spacing_, uneven_);
  limit_moves(constants);
  Frame frame;
  Vec3 turn = Vec3::Zero();
  // What solids hold keeps neither: there the correction would be one more source of noise.
  if (!held_ || items.sample_item.empty()) {
    frame = find_frame(items, extras, constants);
    turn = find_turn(items, extras, constants, frame);
  }
  const auto found = fold<Moved>(uneven_.size(), constants.threads, [&](std::size_t f, Moved& part) {
    Unevenness& u = uneven_[f];
    const Record& own = items.record[items.fluid_item[f]];
    auto move = Eigen::Vector3f::Map(u.push);
    move -= (u.share * (frame.move + (velocity(own) - frame.velocity).cross(turn))).cast<float>();
    // The sum over particles of V_i V_j (m_i - m_j).g r, pairs of particles taken together.
    part.dense += own.volume * move.dot(Eigen::Vector3f::Map(u.dense));
    part.all += move.norm(), part.volume += own.volume;
    part.longest = std::max(part.longest, move.norm());
  });
  expansion_ = found.volume > 0 ? static_cast<float>(-found.dense / found.volume) : 0.f;
  ++report_.steps;
  if (uneven_.empty()) return;
  report_.mean += found.all / spacing_ / static_cast<double>(uneven_.size());
  report_.largest = std::max(report_.largest, found.longest / spacing_);
}

}  // namespace ballast::fluid
