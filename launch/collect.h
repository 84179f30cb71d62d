// Everything that comes out of the report rings during a run: rows to files and memory, step totals, warnings.
#pragma once
#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "common/exchange/link.h"
#include "common/result.h"
#include "common/scene/scene.h"
#include "launch/live_errors.h"
#include "launch/lockstep.h"
#include "launch/table.h"

namespace ballast::launch {

/// Of the values in a table: kAll give the same double back, as bodies have it; kNine are as many as a float has, in
/// which the fluid is computed. Times have nine in both.
enum class Digits { kAll, kNine };

/// A CSV file that gets its name only when close() is called.
class CsvFile {
 public:
  CsvFile() = default;
  Status open(const std::string& path, const std::vector<std::string>& columns, Digits digits);
  /// The error of a full disk comes as soon as the kernel says so.
  Status row(double time, std::span<const double> values);
  Status close();
  /// Takes the name away again.
  void unfinish();

 private:
  Status failed(int reason);
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Closer> file_;
  std::string path_;
  Digits digits_ = Digits::kAll;
};

/// Sums over the step reports of one process.
struct StepTotals {
  std::uint64_t steps = 0;
  double compute_s = 0, wait_s = 0;
  double density_mean_sum = 0;
  std::array<double, 4> max_error{};  ///< as StepReport::error
  exchange::StepReport last{};
};

class Collector {
 public:
  /// Opens the row files of the parts that take part.
  static Result<Collector> make(const Scene& scene, bool fluid, bool rigid, const std::string& out_dir);
  Status take(exchange::Role role, const exchange::Frame& frame);
  Status close();
  /// Takes the names of the closed files away again: a run whose record cannot be written has no whole outputs.
  void unfinish();

  /// What has come from all processes up to one step; wall times are not in it.
  struct Snapshot {
    std::vector<double> body_times, body_values, probe_times, probe_values;
    std::array<StepTotals, 2> totals{};
    std::vector<std::string> warnings;
    template <class A>
    void state(A& a) {
      a("body_times", body_times), a("body_values", body_values);
      a("probe_times", probe_times), a("probe_values", probe_values);
      a("totals", totals), a("warnings", warnings);
    }
  };
  /// How much of it there is at a moment, so that a snapshot of that moment can be made later.
  struct Mark {
    std::size_t body_rows = 0, probe_rows = 0, warnings = 0;
    StepTotals totals{};  ///< of the process that the mark was set for
  };
  Mark mark(exchange::Role role) const;
  /// The rows of bodies as at one mark, those of probes as at another.
  Snapshot snapshot(const Mark& fluid, const Mark& rigid) const;
  /// Starts from a snapshot: rows go into the files again, totals and warnings go on.
  Status go_on(const Snapshot& snapshot);

  const Table& bodies() const { return bodies_; }
  const Table& probes() const { return probes_; }
  const StepTotals& totals(exchange::Role role) const { return totals_[static_cast<std::size_t>(role)]; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  std::uint64_t reported() const { return lockstep_.reported(); }
  /// As far as the step reports have come.
  LiveErrors errors() const;

 private:
  Collector(const Scene& scene, bool fluid, bool rigid);
  void take_step(exchange::Role role, const exchange::StepReport& report);
  Status take_bodies(const exchange::Frame& frame);
  /// Without a fluid process the poses asked for as probes come from the bodies.
  Status take_dry_probes(double time, std::span<const double> bodies);

  const Scene* scene_;
  bool fluid_, rigid_;
  Lockstep lockstep_;
  Table bodies_, probes_;
  CsvFile bodies_file_, probes_file_;
  std::array<StepTotals, 2> totals_{};
  std::vector<std::string> warnings_;
};

}  // namespace ballast::launch
