// Rows over time and the statistics that expectations ask of them.
#include "launch/table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace ballast::launch {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::optional<std::size_t> Table::column(const std::string& name) const {
  const auto found = std::ranges::find(columns, name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

bool Table::add(double time, std::span<const double> row) {
  if (row.size() != columns.size()) return false;
  times.push_back(time);
  values.insert(values.end(), row.begin(), row.end());
  return true;
}

Series window(const Table& table, std::size_t column, double from, double to) {
  Series out;
  const double slack = 1e-9 * std::max(1.0, std::abs(from));  // row times are sums of steps
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (table.times[row] < from - slack || table.times[row] > to + slack) continue;
    out.times.push_back(table.times[row]);
    out.values.push_back(table.at(row, column));
  }
  return out;
}

double slope(const Series& series) {
  const auto n = static_cast<double>(series.times.size());
  if (n < 2) return kNone;
  const double mean_t = std::accumulate(series.times.begin(), series.times.end(), 0.0) / n;
  const double mean_v = std::accumulate(series.values.begin(), series.values.end(), 0.0) / n;
  double tt = 0, tv = 0;
  for (std::size_t i = 0; i < series.times.size(); ++i) {
    tt += (series.times[i] - mean_t) * (series.times[i] - mean_t);
    tv += (series.times[i] - mean_t) * (series.values[i] - mean_v);
  }
  return tt > 0 ? tv / tt : kNone;
}

std::optional<double> interpolate(const Series& series, double time) {
  if (series.times.empty() || time < series.times.front() || time > series.times.back()) return std::nullopt;
  const auto after = std::ranges::lower_bound(series.times, time);
  const auto i = static_cast<std::size_t>(after - series.times.begin());
  if (i == 0 || series.times[i] == time) return series.values[i];
  const double share = (time - series.times[i - 1]) / (series.times[i] - series.times[i - 1]);
  return series.values[i - 1] + share * (series.values[i] - series.values[i - 1]);
}

double statistic(const Series& series, const std::string& name) {
  const std::vector<double>& v = series.values;
  if (v.empty() || std::ranges::any_of(v, [](double x) { return !std::isfinite(x); })) return kNone;
  const auto n = static_cast<double>(v.size());
  const double mean = std::accumulate(v.begin(), v.end(), 0.0) / n;
  if (name == "last") return v.back();
  if (name == "mean") return mean;
  if (name == "min") return *std::ranges::min_element(v);
  if (name == "max") return *std::ranges::max_element(v);
  if (name == "max_abs") return std::abs(*std::ranges::max_element(v, {}, [](double x) { return std::abs(x); }));
  if (name == "change") return v.back() - v.front();
  if (name == "slope") return slope(series);
  if (name == "rms") {
    double sum = 0;
    for (double x : v) sum += (x - mean) * (x - mean);
    return std::sqrt(sum / n);
  }
  return kNone;
}

}  // namespace ballast::launch
