// Rows over time under named columns: what bodies.csv and probes.csv hold, kept for the expectations.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ballast::launch {

struct Table {
  std::vector<std::string> columns;  ///< without the time
  std::vector<double> times;         ///< s, one per row
  std::vector<double> values;        ///< row after row

  std::size_t rows() const { return times.size(); }
  double at(std::size_t row, std::size_t column) const { return values[row * columns.size() + column]; }
  std::optional<std::size_t> column(const std::string& name) const;
  /// False if the number of values is not the number of columns; nothing is added then.
  bool add(double time, std::span<const double> row);
};

/// Times and values of one column within [from, to].
struct Series {
  std::vector<double> times, values;
};
Series window(const Table& table, std::size_t column, double from, double to);

/// Slope of the least-squares line; NaN for fewer than two different times.
double slope(const Series& series);

/// Value at `time` by linear interpolation; nothing outside the series.
std::optional<double> interpolate(const Series& series, double time);

/// last, mean, min, max, max_abs, rms (about the mean), change, slope; NaN for an empty series or an unknown name.
double statistic(const Series& series, const std::string& name);

}  // namespace ballast::launch
