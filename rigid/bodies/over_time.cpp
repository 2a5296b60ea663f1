#include "rigid/bodies/over_time.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rigid/math/elementary.hpp"

namespace silt::rigid {

namespace {

constexpr double period_of_sine = 2 * std::numbers::pi;

double in_table(const std::vector<OverTime::Row>& table, double time) {
  if (time <= table.front().time) return table.front().share;
  const auto next = std::upper_bound(table.begin(), table.end(), time,
                                     [](double t, const OverTime::Row& row) { return t < row.time; });
  if (next == table.end()) return table.back().share;
  const auto& [t0, s0] = *(next - 1);
  return s0 + (time - t0) / (next->time - t0) * (next->share - s0);
}

/// The integral of the table from its first row on; the trapezoidal rule is exact between rows.
double from_first_row(const std::vector<OverTime::Row>& table, double time) {
  double sum = std::min(time - table.front().time, 0.) * table.front().share;
  for (std::size_t k = 0; k < table.size() && table[k].time < time; ++k) {
    const double end = k + 1 < table.size() ? std::min(time, table[k + 1].time) : time;
    sum += (end - table[k].time) * 0.5 * (table[k].share + in_table(table, end));
  }
  return sum;
}

}  // namespace

double OverTime::at(double time) const {
  const double share = table.empty() ? 1 : in_table(table, time);
  return amplitude == 0 ? share
                        : share + amplitude * elementary::sin(period_of_sine * frequency * time + phase);
}

double OverTime::integral(double time) const {
  const double sum = table.empty() ? time : from_first_row(table, time) - from_first_row(table, 0);
  if (amplitude == 0) return sum;
  const double swing = period_of_sine * frequency;
  if (swing == 0) return sum + amplitude * elementary::sin(phase) * time;
  return sum + amplitude / swing * (elementary::cos(phase) - elementary::cos(swing * time + phase));
}

double OverTime::most() const {
  double share = table.empty() ? 1 : 0;
  for (const Row& row : table) share = std::max(share, std::abs(row.share));
  return share + std::abs(amplitude);
}

}  // namespace silt::rigid
