// Solves x = H(x) where H is dear and its derivative unknown: IQN-ILS (Degroote, Bathe and Vierendeels 2009). With the
// differences of the iterates so far, V of the residuals r = H(x) - x and W of the images H(x), the next one is
//   x' = H(x) + W c,  c = argmin |V c + r|,
// which ends after hardly more than n + 1 iterations if H is linear in n unknowns. Columns that depend on newer ones
// are left out. Where there is none yet, and from the best iterate where none has helped for a while, a step relaxed
// after Aitken is taken instead.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace ballast::fluid {

class QuasiNewton {
 public:
  /// A new problem begins.
  void begin();
  /// The next iterate, from the one at hand and its residual.
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& residual);

 private:
  struct Column {  // differences between two iterates
    Eigen::VectorXd residual, image;
  };
  void take(const Eigen::VectorXd& residual, const Eigen::VectorXd& image);

  std::vector<Column> columns_;       // newest first
  Eigen::VectorXd residual_, image_;  // last; empty before the first
  Eigen::VectorXd best_, best_residual_;
  int without_progress_ = 0;  // iterations
  double omega_ = 1;          // last relaxation
};

}  // namespace ballast::fluid
