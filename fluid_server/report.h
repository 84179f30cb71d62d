// What the fluid process reports: ledger, step limits, errors, warnings, ParaView files and the picture.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "common/exchange/link.h"
#include "common/exchange/sleep.h"
#include "common/geometry/bodies.h"
#include "common/output/vtk.h"
#include "fluid_server/step/energy.h"
#include "fluid_server/step/interface.h"
#include "fluid_server/step/wcsph.h"

namespace ballast::fluid {

class Report {
 public:
  Report(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid, std::string out_dir);

  /// For the record and for monitors.
  void warn(std::string text);
  /// Books the search for the starting pressure.
  void quiet(const QuietReport& quiet);
  /// Books one finished step, which took the bodies from `before` to `after`.
  void count(Limit limit, std::span<const exchange::BodyState> before, std::span<const exchange::BodyState> after,
             double dt, double time);
  /// Books a step of length dt that was slept through.
  void count_slept(double dt, std::span<const exchange::BodyState> states);
  /// Books what the two processes disagreed about in the step just counted.
  void interface(Interface& interface, double time);
  /// Measured last (every 20 steps).
  const Measures& measured() const { return last_; }
  EnergyBalance& energy() { return energy_; }
  exchange::StepReport step_report(std::uint64_t step, double time, const Step& dt, std::uint64_t hash);
  /// Sends warnings that have come up since the last call.
  Status new_warnings(exchange::Link& link, std::uint64_t step, double time);
  /// ParaView files of this moment, if the scene wants them.
  Status write_frame(std::span<const exchange::BodyState> states, double time);
  /// Picture of the last state, if the scene wants one.
  void write_final(std::span<const exchange::BodyState> states, std::uint32_t threads);
  /// Particles and bodies of a run that diverged, for ParaView: OUT/post_mortem.
  Status write_post_mortem(std::span<const exchange::BodyState> states, double time) const;
  /// For checkpoints: the whole run's sums and warnings. Warnings that a resumed run takes over are sent once more.
  template <class A>
  void state(A& a) {
    a("limits", limits_), a("impulse", impulse_), a("impulse_scale", impulse_scale_);
    a("angular_impulse", angular_impulse_);
    a("impulse_total", impulse_total_), a("quiet", quiet_), a("start", start_), a("last", last_);
    a("steps_since_measure", steps_since_measure_), a("error_mean_sum", error_mean_sum_), a("error_max", error_max_);
    a("worst_mach", worst_mach_), a("error_count", error_count_), a("lost_seen", lost_seen_);
    a("warnings", warnings_), a("energy", energy_);
    if (vtk_) a("vtk", *vtk_);
  }

  /// Largest speed over sound speed so far.
  double worst_mach() const { return worst_mach_; }
  std::string json(std::uint64_t step, double time, bool stopped, std::span<const exchange::BodyState> states,
                   const exchange::Link& link, const Status& outcome, const exchange::Sleep& sleep,
                   const Interface& interface) const;

 private:
  void count_impulses(double dt, std::span<const exchange::BodyState> states);
  void settled(const QuietReport& quiet);
  void count_energy(double time);
  void warn_of_thin_solids();

  const Scene& scene_;
  const std::vector<Body>& bodies_;
  const WcsphFluid& fluid_;
  std::string out_dir_;
  std::array<std::uint64_t, static_cast<std::size_t>(Limit::kCount)> limits_{};
  std::vector<Vec3> impulse_;          // given to each body, N s
  std::vector<Vec3> angular_impulse_;  // likewise, about the origin, N m s; static ones too
  double impulse_scale_ = 0;           // sum of magnitudes
  Vec3 impulse_total_ = Vec3::Zero();  // given to all bodies that move
  QuietReport quiet_;
  EnergyBalance energy_;
  Measures start_;
  Measures last_;
  std::uint64_t steps_since_measure_ = 0;
  double error_mean_sum_ = 0, error_max_ = 0, worst_mach_ = 0;
  std::uint64_t error_count_ = 0;
  std::vector<std::string> warnings_;
  std::size_t warnings_sent_ = 0;
  std::uint64_t lost_seen_ = 0;
  double interface_residual_ = 0;  // of the last step
  std::unique_ptr<output::VtkSeries> vtk_;
};

/// Limits of the step that stay the same through a run.
StepLimits step_limits(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid);

/// Final report of a process that could not start.
std::string failure_json(const Error& error);

}  // namespace ballast::fluid
