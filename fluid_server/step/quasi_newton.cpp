// IQN-ILS with filtering and a relaxed step to fall back on.
#include "fluid_server/step/quasi_newton.h"

#include <Eigen/QR>
#include <algorithm>

namespace ballast::fluid {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A column of which newer ones leave less than this is noise: residuals come from sums in single precision.
constexpr double kIndependent = 1e-3;
constexpr int kPatience = 3;  // iterations without progress: the columns mislead, as on the other side of a kink
constexpr double kLeastRelaxation = 0.05, kMostRelaxation = 1;

void append(MatrixXd& to, const VectorXd& column) {
  to.conservativeResize(column.size(), to.cols() + 1);
  to.rightCols<1>() = column;
}

}  // namespace

void QuasiNewton::begin() { *this = {}; }

/// A column, and Aitken's factor, from this iterate and the last one.
void QuasiNewton::take(const VectorXd& residual, const VectorXd& image) {
  if (residual_.size() > 0) {
    const VectorXd change = residual - residual_;
    if (const double size = change.squaredNorm(); size > 0)
      omega_ = std::clamp(-omega_ * residual_.dot(change) / size, kLeastRelaxation, kMostRelaxation);
    columns_.insert(columns_.begin(), {change, image - image_});
  }
  residual_ = residual, image_ = image;
}

VectorXd QuasiNewton::next(const VectorXd& x, const VectorXd& residual) {
  take(residual, x + residual);
  ++without_progress_;
  if (best_.size() == 0 || residual.norm() < best_residual_.norm())
    best_ = x, best_residual_ = residual, without_progress_ = 0;
  if (without_progress_ >= kPatience) {
    columns_.clear();
    without_progress_ = 0;
    return best_ + omega_ * best_residual_;
  }
  MatrixXd basis(x.size(), 0), v, w;
  std::erase_if(columns_, [&](const Column& c) {
    VectorXd rest = c.residual;
    for (int pass = 0; pass < 2; ++pass) rest -= basis * (basis.transpose() * rest);
    if (!(rest.norm() > kIndependent * c.residual.norm()) || basis.cols() == x.size()) return true;
    append(basis, rest.normalized()), append(v, c.residual), append(w, c.image);
    return false;
  });
  if (columns_.empty()) return x + omega_ * residual;
  return image_ + w * v.householderQr().solve(-residual);
}

}  // namespace ballast::fluid
