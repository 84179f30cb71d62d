// The rigid process's part of the run record: rows of bodies, momentum received, contact sets checked, jitter, timings.
#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/exchange/link.h"
#include "common/exchange/sleep.h"

namespace ballast::rigid {

/// What happened in one step, kept until the fluid has accepted it (an order to roll back voids it).
struct StepRecord {
  exchange::StepReport report{};
  std::vector<exchange::BodyState> states;
  std::vector<exchange::Wrench> wrenches;
  std::size_t contacts = 0;
  double force_mismatch = 0;  ///< relative: sum of contact forces against the wrench, worst body
  bool asleep = false;        ///< slept through: nothing moved, whatever the velocities say
  template <class A>
  void state(A& a) {
    a("report", report), a("states", states), a("wrenches", wrenches);
    a("contacts", contacts), a("force_mismatch", force_mismatch), a("asleep", asleep);
  }
};

/// Worst difference between a body's wrench and the sum of its contact forces, relative to the largest force of the
/// step. Bodies without contacts are left out: sets may be switched off.
double force_mismatch(std::span<const exchange::Wrench> wrenches, std::span<const exchange::Contact> contacts);

class ClientReport {
 public:
  explicit ClientReport(const exchange::ManifestView& manifest);

  /// Row of the initial state; steps follow with accept(), the last row with last().
  Status begin(exchange::Link& link, std::span<const exchange::BodyState> states);
  Status accept(exchange::Link& link, const StepRecord& step);
  Status last(exchange::Link& link);
  void warn(exchange::Link& link, const std::string& text);
  /// What energies are counted with from now on.
  void gravity(const double* values) { std::copy_n(values, 3, gravity_.begin()); }
  const StepRecord& last_step() const { return last_; }
  /// Warnings that a resumed run takes over: once more to the coordinator.
  Status warn_again(exchange::Link& link) const;

  /// For checkpoints: the whole run's sums, and the last step, from which the next row and the next sum start.
  template <class A>
  void state(A& a) {
    a("last", last_), a("last_row", last_row_), a("last_row_written", last_row_written_), a("steps", steps_);
    a("contact_sets", contact_sets_), a("contacts", contacts_), a("force_mismatch_max", force_mismatch_max_);
    a("impulse", impulse_), a("impulse_total", impulse_total_), a("impulse_scale", impulse_scale_);
    a("energy_start", energy_start_), a("work", work_);
    a("jitter_max", jitter_max_), a("jitter_sum", jitter_sum_), a("jitter_steps", jitter_steps_);
    a("warnings", warnings_), a("gravity", gravity_);
  }

  struct Timing {
    double start_s = 0, engine_s = 0, read_s = 0, report_s = 0, waiting_s = 0, wall_s = 0;
  };
  /// The final report as JSON text; `error` is empty where all went well.
  std::string json(const std::string& engine, const Timing& timing, const std::string& error,
                   const exchange::Sleep& sleep) const;

 private:
  Status row(exchange::Link& link, const StepRecord& step);
  void count_momentum(const StepRecord& step);
  void count_jitter(const StepRecord& step);
  double energy(std::span<const exchange::BodyState> states) const;

  exchange::ManifestView manifest_;
  StepRecord last_;
  std::vector<double> values_;
  std::int64_t last_row_ = 0;
  bool last_row_written_ = false;
  std::uint64_t steps_ = 0, contact_sets_ = 0, contacts_ = 0;
  double force_mismatch_max_ = 0;
  std::vector<Eigen::Vector3d> impulse_;  // per body, N s
  Eigen::Vector3d impulse_total_ = Eigen::Vector3d::Zero();
  double impulse_scale_ = 0;
  double energy_start_ = 0, work_ = 0;
  std::array<double, 3> gravity_{};              // m/s^2, at the moment
  std::vector<double> jitter_max_, jitter_sum_;  // m/s^2
  std::uint64_t jitter_steps_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace ballast::rigid
