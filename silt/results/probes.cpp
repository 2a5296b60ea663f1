#include "silt/results/probes.hpp"

#include <fmt/format.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

#include "silt/case/case.hpp"
#include "silt/results/flow_fields.hpp"

namespace silt {

using lbm::Int3;
using rigid::Vec3;

namespace {

constexpr double not_there = -std::numeric_limits<double>::infinity();

// The stencil of a point: the eight cells around it, and the outward neighbours of each along the axes.
constexpr int cells_seen = 32;

bool is_corner(int k) {
  return k % 4 == 0;
}

Int3 cell_seen(Int3 low, int k) {
  const int corner = k / 4, outward = k % 4 - 1;
  Int3 cell = low + Int3{corner & 1, corner >> 1 & 1, corner >> 2};
  if (!is_corner(k)) cell[outward] += corner >> outward & 1 ? 1 : -1;
  return cell;
}

/// Returns the lowest of the eight cells around a point, in cells.
Int3 lowest_around(const Vec3& x) {
  return {int(std::floor(x[0] - 0.5)), int(std::floor(x[1] - 0.5)), int(std::floor(x[2] - 0.5))};
}

Vec3 from_point(const Vec3& x, Int3 cell) {
  return Vec3(cell.x + 0.5, cell.y + 0.5, cell.z + 0.5) - x;
}

/// Calls visit(block, local cell) if this rank has a cell, or its periodic image.
template <class Visit>
void with_cell(const coupler::FluidFields& fields, Int3 cell, Visit&& visit) {
  cell = fields.domain().wrapped(cell);
  for (int b = 0; b < fields.blocks(); ++b)
    if (fields.block(b).contains(cell)) return visit(b, cell - fields.block(b).lower);
}

/// Least-squares linear fits, one per column: value = mean + (x - centre) * gradient. Constant along
/// directions that the points do not determine.
struct Linear {
  Eigen::RowVector3d centre;
  Eigen::RowVectorXd mean;
  Eigen::MatrixXd gradient;

  Linear(const Eigen::MatrixX3d& places, const Eigen::MatrixXd& values)
      : centre(places.colwise().mean()), mean(values.colwise().mean()) {
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> of_places(places.rowwise() - centre);
    of_places.setThreshold(1e-6);
    gradient = of_places.solve(values.rowwise() - mean);
  }
  Eigen::RowVectorXd at(const Vec3& x) const { return mean + (x.transpose() - centre) * gradient; }
};

}  // namespace

int Probes::numbers() const {
  int count = 0;
  for (const Field field : spec_.quantities) count += numbers_of(field);
  return count;
}

std::size_t Probes::width() const {
  return 1 + std::size_t(levels_) * cells_seen * numbers();
}

void Probes::see_cell(const coupler::FluidFields& fields, int block, Int3 cell, double* numbers) const {
  if (!fields.is_fluid(block, cell)) return;
  lbm::MomentsByRow moments(fields, block, cell.x, cell.x + 1);
  const lbm::Moments m = moments(cell);
  for (const Field field : spec_.quantities)
    if (field == Field::velocity)
      for (const double u : fields.velocity(m)) *numbers++ = u;
    else if (field == Field::temperature)
      *numbers++ = fields.temperature(block, cell);
    else
      *numbers++ = scalar_of(fields, field, m);
}

/// Notes this rank's cells of a level in the stencil of a point.
void Probes::see(const coupler::FluidFields& fields, const Vec3& point, std::span<double> of_point) const {
  const Vec3 x = point / fields.width();
  Int3 own;
  for (int d = 0; d < 3; ++d) own[d] = std::min(int(x[d]), fields.domain().cells()[d] - 1);
  with_cell(fields, own, [&](int, Int3) { of_point[0] = fields.level(); });
  const Int3 low = lowest_around(x);
  double* const cells = &of_point[1 + std::size_t(fields.level()) * cells_seen * numbers()];
  for (int k = 0; k < cells_seen; ++k)
    with_cell(fields, cell_seen(low, k),
              [&](int b, Int3 local) { see_cell(fields, b, local, cells + k * numbers()); });
}

void Probes::look(const Simulation& simulation) {
  finish(simulation.setup());
  const coupler::Flow& flow = *simulation.scene().flow;
  levels_ = flow.levels();
  step_ = simulation.steps_done();
  std::vector<double> seen(width() * spec_.points.size(), not_there);
  flow.for_levels([&](const coupler::FluidFields& fields) {
    for (std::size_t p = 0; p < spec_.points.size(); ++p)
      see(fields, spec_.points[p], std::span(seen).subspan(p * width(), width()));
  });
  seen_.start(simulation.scene().comm, std::move(seen));
}

/// Returns the values at a point; NaN if no cell around it is fluid.
std::vector<double> Probes::at(const Vec3& point, const double* of_point) const {
  const int level = int(of_point[0]), count = numbers();
  const double* const cells = of_point + 1 + std::size_t(level) * cells_seen * count;
  const auto of_cell = [&](int k) { return Eigen::Map<const Eigen::RowVectorXd>(cells + k * count, count); };
  const auto is_there = [&](int k) { return cells[k * count] != not_there; };
  const Vec3 x = point / (1 << level);
  const Int3 low = lowest_around(x);
  const auto place = [&](int k) { return from_point(x, cell_seen(low, k)); };
  const auto weight = [&](int k) { return (1 - place(k).array().abs()).prod(); };
  Eigen::RowVectorXd value = Eigen::RowVectorXd::Zero(count);
  double there = 0, missing = 0;
  std::vector<int> known;  // outward cells only behind a fluid one, not across a thin wall
  for (int k = 0; k < cells_seen; ++k) {
    if (is_there(k) && is_there(k - k % 4)) known.push_back(k);
    if (!is_corner(k)) continue;
    (is_there(k) ? there : missing) += weight(k);
    if (is_there(k)) value += weight(k) * of_cell(k);
  }
  if (missing > 0 && there > 0) {
    Eigen::MatrixX3d places(known.size(), 3);
    Eigen::MatrixXd values(known.size(), count);
    for (std::size_t i = 0; i < known.size(); ++i)
      places.row(i) = place(known[i]).transpose(), values.row(i) = of_cell(known[i]);
    const Linear linear(places, values);
    for (int k = 0; k < cells_seen; k += 4)
      if (!is_there(k)) value += weight(k) * linear.at(place(k));
  }
  if (there <= 0) value.setConstant(std::numeric_limits<double>::quiet_NaN());
  return {value.begin(), value.end()};
}

std::string Probes::columns() const {
  std::string names = "step,time,point,x,y,z";
  for (const Field field : spec_.quantities)
    for (int k = 0; k < numbers_of(field); ++k)
      names +=
          fmt::format(",{}{}", field_names[field], numbers_of(field) == 3 ? std::string{'.', "xyz"[k]} : "");
  return names;
}

std::vector<std::string> Probes::places(const Case& setup) const {
  std::vector<std::string> places;
  for (std::size_t p = 0; p < spec_.points.size(); ++p) {
    std::string& place = places.emplace_back(fmt::format("{}", p));
    for (const double x : spec_.points[p])
      place += ',' + csv_number(setup.units.physical(x, dimension::length));
  }
  return places;
}

TableRows Probes::take_rows(const Case& setup) {
  finish(setup);
  return std::exchange(rows_, {});
}

/// Adds the rows of the last sample, if it is unfinished.
void Probes::finish(const Case& setup) {
  if (levels_ == 0) return;
  const std::vector<double>& seen = seen_.finish();
  const Units& units = setup.units;
  const std::vector<std::string> places = this->places(setup);
  std::string& text = rows_.text;
  for (std::size_t p = 0; p < spec_.points.size(); ++p) {
    const std::vector<double> numbers = at(spec_.points[p], &seen[p * width()]);
    text += fmt::format("{},{},{}", step_, double(step_) * units.time_step, places[p]);
    int k = 0;
    for (const Field field : spec_.quantities)
      for (const int end = k + numbers_of(field); k < end; ++k) {
        const double number = field == Field::shear_rate && numbers[k] < 0 ? 0 : numbers[k];
        text += ',' + csv_number(units.physical(number, dimension_of(field)));
      }
    text += '\n';
  }
  rows_.last_step = step_;
  levels_ = 0;
}

}  // namespace silt
