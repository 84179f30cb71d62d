// Wall time of a scope, added to a sum.
#pragma once
#include <chrono>

namespace ballast {

/// Adds the wall time from its beginning to its end to `total`, s.
class AddingWatch {
 public:
  explicit AddingWatch(double& total) : total_(total) {}
  ~AddingWatch() { total_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  AddingWatch(const AddingWatch&) = delete;
  AddingWatch& operator=(const AddingWatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& total_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace ballast
