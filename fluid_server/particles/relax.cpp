// Relaxing the start.
#include "fluid_server/particles/relax.h"

#include <algorithm>
#include <cmath>

namespace ballast::fluid {

namespace {

constexpr double kStillMove = 5e-4;  // spacings per round
constexpr double kKeep = 0.8;  // of its last move that a particle makes again: a fifth of the rounds for the same end
// Done, too, when so many rounds did not narrow the spread to this share of what it was before them.
constexpr int kLook = 50;
constexpr double kGain = 0.95;

double spread(const std::vector<float>& delta) {
  double sum = 0, sum2 = 0;
  for (float x : delta) sum += x, sum2 += static_cast<double>(x) * x;
  const double n = static_cast<double>(delta.size()), mean = sum / n;
  return std::sqrt(std::max(sum2 / n - mean * mean, 0.0));
}

}  // namespace

RelaxReport relax(Particles& particles, std::span<const Record> solid, const Coordinates& coordinates,
                  const PassConstants& constants, double spacing, bool shifting, int at_most,
                  const std::function<void()>& sign_of_life) {
  RelaxReport report;
  Neighbourhood items(coordinates, constants.kernel.support, constants.kernel.dimension, constants.threads);
  items.set_static_samples(solid);
  Particles sorted;
  std::vector<float> delta, gradient;
  std::vector<Unevenness> uneven;
  std::vector<Vec3> last(particles.size(), Vec3::Zero());  // move of each particle, by id
  double earlier = 0;
  const double step = 0.2 * spacing * spacing, longest = 0.1 * spacing;
  for (int round = 0; round < at_most; ++round) {
    sign_of_life();
    items.rebuild(particles, sorted, {}, 0);
    build_lists(items, constants);
    sum_density(items, constants, delta, gradient);
    if (shifting) find_unevenness(items, constants, spacing, uneven);
    if (round == 0) report.spread_before = spread(delta);
    report.spread_after = spread(delta);
    if (round % kLook == 0) {
      if (round > 0 && report.spread_after > kGain * earlier) return report;
      earlier = report.spread_after;
    }
    double largest = 0;
#pragma omp parallel for num_threads(constants.threads) schedule(static) reduction(max : largest)
    for (std::size_t f = 0; f < sorted.size(); ++f) {
      Record& r = sorted.record[f];
      const Eigen::Vector3f push = shifting ? Eigen::Vector3f(Eigen::Vector3f::Map(uneven[f].push))
                                            : Eigen::Vector3f(-Eigen::Vector3f::Map(&gradient[3 * f]));
      Vec3 move = kKeep * last[sorted.id[f]] + step * push.cast<double>();
      const double length = move.norm();
      if (length > longest) move *= longest / length;
      last[sorted.id[f]] = move;
      largest = std::max(largest, std::min(length, longest));
      r.x += static_cast<std::uint32_t>(static_cast<std::int64_t>(std::lround(move[0] / coordinates.quantum[0])));
      r.y += static_cast<std::uint32_t>(static_cast<std::int64_t>(std::lround(move[1] / coordinates.quantum[1])));
      r.z += static_cast<std::uint32_t>(static_cast<std::int64_t>(std::lround(move[2] / coordinates.quantum[2])));
    }
    std::swap(particles, sorted);
    report.moves = round + 1;
    report.last_move = largest / spacing;
    if (report.last_move < kStillMove) return report;
  }
  report.settled = at_most == 0;
  return report;
}

}  // namespace ballast::fluid
