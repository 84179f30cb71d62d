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

}  // namespace

void Shifting::find(const Neighbourhood& items, const PassConstants& constants) {
  find_unevenness(items, constants, spacing_, uneven_);
  const float d = static_cast<float>(spacing_),
              rate = kStrength * static_cast<float>(constants.kernel.h()) * constants.dt;
  std::vector<float> longest((uneven_.size() + kSumBlock - 1) / kSumBlock, 0.f);
  const auto [dense, moved, volume] =
      sum_blocks<3>(uneven_.size(), constants.threads, [&](std::size_t begin, std::size_t end) {
        std::array<double, 3> sum{};
        for (std::size_t f = begin; f < end; ++f) {
          Unevenness& u = uneven_[f];
          const float inside = std::clamp((u.fullness - kSurface) / (kInside - kSurface), 0.f, 1.f) *
                               std::clamp(1 - u.solid / kSolid, 0.f, 1.f);
          auto move = Eigen::Vector3f::Map(u.push);
          move *= inside * std::min(rate * u.speed, kOvershoot * d * d);
          const float length = move.norm();
          if (length > kFarthest * d) move *= kFarthest * d / length;
          const float own = items.record[items.fluid_item[f]].volume;
          // The sum over particles of V_i V_j (m_i - m_j).g r, pairs of particles taken together.
          sum[0] += own * move.dot(Eigen::Vector3f::Map(u.dense));
          sum[1] += std::min(length, kFarthest * d), sum[2] += own;
          longest[begin / kSumBlock] = std::max(longest[begin / kSumBlock], std::min(length, kFarthest * d));
        }
        return sum;
      });
  expansion_ = volume > 0 ? static_cast<float>(-dense / volume) : 0.f;
  ++report_.steps;
  if (uneven_.empty()) return;
  report_.mean += moved / spacing_ / static_cast<double>(uneven_.size());
  report_.largest = std::max<double>(report_.largest, *std::max_element(longest.begin(), longest.end()) / spacing_);
}

}  // namespace ballast::fluid
