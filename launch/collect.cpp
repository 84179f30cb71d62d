// Frames to rows, totals and warnings; each frame is checked before it is believed.
#include "launch/collect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <limits>

#include "common/output/columns.h"
#include "common/output/whole_file.h"

namespace ballast::launch {

using exchange::Frame;
using exchange::FrameKind;
using exchange::Role;
using exchange::StepReport;

Status CsvFile::open(const std::string& path, const std::vector<std::string>& columns, Digits digits) {
  path_ = path;
  digits_ = digits;
  file_.reset(std::fopen((path + ".part").c_str(), "w"));
  if (!file_) return output::write_error(path, errno);
  std::fputs("t", file_.get());
  for (const std::string& column : columns) std::fprintf(file_.get(), ",%s", column.c_str());
  std::fputc('\n', file_.get());
  return ok();
}

Status CsvFile::row(double time, std::span<const double> values) {
  if (!file_) return ok();
  fmt::memory_buffer line;
  fmt::format_to(std::back_inserter(line), "{:.9g}", time);  // the same in both tables
  for (double value : values) {
    fmt::format_to(std::back_inserter(line), fmt::runtime(digits_ == Digits::kAll ? ",{}" : ",{:.9g}"), value);
  }
  line.push_back('\n');
  errno = 0;
  std::fwrite(line.data(), 1, line.size(), file_.get());
  if (std::ferror(file_.get()) != 0) return failed(errno);
  return ok();
}

/// Once said, a full disk is not said again at the end.
Status CsvFile::failed(int reason) {
  file_.reset();
  return output::write_error(path_, reason);
}

Status CsvFile::close() {
  if (!file_) return ok();
  if (std::fflush(file_.get()) != 0 || std::rename((path_ + ".part").c_str(), path_.c_str()) != 0) return failed(errno);
  file_.reset();
  return ok();
}

void CsvFile::unfinish() { std::rename(path_.c_str(), (path_ + ".part").c_str()); }

Collector::Collector(const Scene& scene, bool fluid, bool rigid)
    : scene_(&scene), fluid_(fluid), rigid_(rigid), lockstep_(fluid && rigid) {
  bodies_.columns = output::body_columns(scene);
  probes_.columns = output::probe_columns(scene);
}

Result<Collector> Collector::make(const Scene& scene, bool fluid, bool rigid, const std::string& out_dir) {
  Collector out(scene, fluid, rigid);
  if (rigid) {
    if (Status s = out.bodies_file_.open(out_dir + "/bodies.csv", out.bodies_.columns, Digits::kAll); !s)
      return s.error();
  }
  if (!out.probes_.columns.empty()) {
    if (Status s = out.probes_file_.open(out_dir + "/probes.csv", out.probes_.columns, Digits::kNine); !s)
      return s.error();
  }
  return out;
}

Status Collector::take(Role role, const Frame& frame) {
  switch (frame.head.kind) {
    case FrameKind::kStep: {
      const StepReport report = frame.step_report();
      take_step(role, report);
      return lockstep_.take(role, report);
    }
    case FrameKind::kBodies:
      return role == Role::kRigid ? take_bodies(frame) : ok();
    case FrameKind::kProbes:
      if (!probes_.add(frame.head.time, frame.values())) {
        return Error{fmt::format("the {} sent {} probe values, {} were expected", exchange::role_name(role),
                                 frame.values().size(), probes_.columns.size()),
                     "both programs must come from the same build", "", kProcessFailed};
      }
      return probes_file_.row(frame.head.time, frame.values());
    case FrameKind::kWarning: {
      std::string text = frame.text();
      if (std::ranges::find(warnings_, text) == warnings_.end()) warnings_.push_back(std::move(text));
      return ok();
    }
    case FrameKind::kFluid:
    case FrameKind::kContacts:
    case FrameKind::kParticles:
      return ok();  // for monitors only
    case FrameKind::kCheckpoint:
    case FrameKind::kCommand:
      return ok();  // the driver has others for these
  }
  return Error{fmt::format("the {} sent a frame of unknown kind {}", exchange::role_name(role),
                           static_cast<std::uint32_t>(frame.head.kind)),
               "both programs must come from the same build", "", kProcessFailed};
}

void Collector::take_step(Role role, const StepReport& report) {
  StepTotals& totals = totals_[static_cast<std::size_t>(role)];
  if (report.step != totals.last.step) ++totals.steps;  // repeated iterations of a step count once
  totals.compute_s += report.wall_compute;
  totals.wait_s += report.wall_wait;
  totals.density_mean_sum += report.error[0];
  for (std::size_t k = 0; k < 4; ++k) totals.max_error[k] = std::max(totals.max_error[k], report.error[k]);
  totals.last = report;
}

Status Collector::take_bodies(const Frame& frame) {
  if (!bodies_.add(frame.head.time, frame.values())) {
    return Error{fmt::format("the rigid process sent {} body values, {} were expected", frame.values().size(),
                             bodies_.columns.size()),
                 "both programs must come from the same build", "", kProcessFailed};
  }
  if (Status s = bodies_file_.row(frame.head.time, frame.values()); !s) return s;
  if (!fluid_ && !probes_.columns.empty()) return take_dry_probes(frame.head.time, frame.values());
  return ok();
}

Status Collector::take_dry_probes(double time, std::span<const double> bodies) {
  const std::vector<int> moving = output::moving_models(*scene_);
  std::vector<double> row;
  for (const Probe& probe : scene_->probes) {
    std::size_t body = 0;
    while (body < moving.size() && scene_->models[static_cast<std::size_t>(moving[body])].name != probe.target) ++body;
    const std::size_t first = body * output::kBodyValues;
    if (probe.kind == ProbeKind::kPose) {
      for (std::size_t k = 0; k < 7; ++k) {
        row.push_back(body < moving.size() ? bodies[first + k] : std::numeric_limits<double>::quiet_NaN());
      }
    } else if (probe.kind == ProbeKind::kForce) {
      row.insert(row.end(), 6, 0.0);  // no fluid, no force of it
    } else {
      row.push_back(std::numeric_limits<double>::quiet_NaN());  // no fluid: no level, no pressure
    }
  }
  probes_.add(time, row);
  return probes_file_.row(time, row);
}

LiveErrors Collector::errors() const {
  LiveErrors out;
  if (const StepReport& last = totals(Role::kFluid).last; fluid_ && last.step > 0) {
    out.density_mean = last.error[0], out.density_max = last.error[1];
    if (last.error[2] > 0) out.pressure = last.error[2];
    if (rigid_) out.interface = last.error[3];
    out.mass = last.mass_drift;
    if (!std::isnan(last.energy_gain)) out.energy = last.energy_gain;
  }
  out.momentum = lockstep_.imbalance();
  return out;
}

Collector::Mark Collector::mark(Role role) const {
  return {bodies_.rows(), probes_.rows(), warnings_.size(), totals(role)};
}

Collector::Snapshot Collector::snapshot(const Mark& fluid, const Mark& rigid) const {
  // Without a fluid process the rows of probes come from the bodies.
  const Mark& probes = fluid_ ? fluid : rigid;
  const auto first = [](const std::vector<double>& values, std::size_t count) {
    return std::vector<double>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
  };
  Snapshot out{first(bodies_.times, rigid.body_rows),
               first(bodies_.values, rigid.body_rows * bodies_.columns.size()),
               first(probes_.times, probes.probe_rows),
               first(probes_.values, probes.probe_rows * probes_.columns.size()),
               {fluid.totals, rigid.totals},
               {}};
  for (StepTotals& totals : out.totals) totals.compute_s = totals.wait_s = 0;
  const std::size_t warnings = std::max(fluid.warnings, rigid.warnings);
  out.warnings.assign(warnings_.begin(), warnings_.begin() + static_cast<std::ptrdiff_t>(warnings));
  return out;
}

Status Collector::go_on(const Snapshot& from) {
  const auto fill = [](Table& table, CsvFile& file, std::span<const double> times,
                       std::span<const double> values) -> Status {
    const std::size_t n = table.columns.size();
    for (std::size_t row = 0; row < times.size(); ++row) {
      table.add(times[row], values.subspan(row * n, n));
      if (Status s = file.row(times[row], values.subspan(row * n, n)); !s) return s;
    }
    return ok();
  };
  if (Status s = fill(bodies_, bodies_file_, from.body_times, from.body_values); !s) return s;
  if (Status s = fill(probes_, probes_file_, from.probe_times, from.probe_values); !s) return s;
  totals_ = from.totals;
  warnings_ = from.warnings;
  lockstep_.go_on(totals_[fluid_ ? 0 : 1].last.step);
  return ok();
}

Status Collector::close() {
  if (Status s = bodies_file_.close(); !s) return s;
  return probes_file_.close();
}

void Collector::unfinish() {
  bodies_file_.unfinish();
  probes_file_.unfinish();
}

}  // namespace ballast::launch
