// Particles in gaps that are too narrow for them.
#include <algorithm>

#include "fluid_server/pressure/implicit.h"

namespace ballast::fluid {

/// Between solids that leave next to no room a particle has solids all around, and what it is asked to bear moves it no
/// longer. It gets the mean pressure of the particles around, as the film does that water really is there
/// (boundary/seepage), and follows the solids. Its row becomes that statement, so that the matrix stays symmetric.
void ImplicitPressure::hold_squeezed() {
  constexpr double kFirm = 1e3;  // of the mean diagonal
  held_.clear();
  const Coordinates& coordinates = items_->coordinates();
  const Eigen::Map<const Eigen::Vector3f> gravity(constants_->gravity);
  for (std::uint32_t f = 0; f < rows_.size(); ++f) {
    if (!(rows_[f].room < kShut)) continue;
    const std::uint32_t item = items_->fluid_item[f];
    const Record& own = items_->record[item];
    const std::uint32_t* list = items_->lists.of(item);
    float weights = 0, sum = 0;
    for (std::uint32_t k = 0; k < items_->lists.count[item]; ++k) {
      const Record& other = items_->record[list[k]];
      if (!(other.volume > 0)) continue;
      Eigen::Vector3f r = coordinates.difference({own.x, own.y, own.z}, {other.x, other.y, other.z}).cast<float>();
      if (constants_->kernel.dimension == 2) r[1] = 0;
      const float weight = static_cast<float>(constants_->kernel.value(r.norm()));
      weights += weight;
      sum += weight * (pressure_[items_->source[list[k]]] + extras_->density_of(item) * gravity.dot(r));
    }
    if (!(weights > 0)) continue;
    pressure_[f] = std::max(sum / weights, 0.f);
    const float firm = static_cast<float>(kFirm * mean_diagonal_);
    yielding_[f] += firm, diagonal_[f] += firm;
    held_.push_back({f, firm * pressure_[f]});
  }
}

}  // namespace ballast::fluid
