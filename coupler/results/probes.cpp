#include "coupler/results/probes.hpp"

#include <fmt/format.h>

#include <cmath>

#include "coupler/case/case.hpp"
#include "coupler/results/flow_fields.hpp"

namespace silt::coupler {

using lbm::Int3;
using rigid::ExactSum;
using rigid::Vec3;

namespace {

/// Calls visit(block, local cell) where this rank has a cell, which may be beyond a periodic side.
template <class Visit>
void with_cell(const FluidFields& fields, Int3 cell, Visit&& visit) {
  cell = fields.domain().wrapped(cell);
  for (int b = 0; b < fields.blocks(); ++b)
    if (fields.block(b).contains(cell)) return visit(b, cell - fields.block(b).lower);
}

}  // namespace

int Probes::terms() const {
  int count = 1;
  for (const Field field : spec_.quantities) count += numbers_of(field);
  return count;
}

void Probes::add_cell(const FluidFields& fields, int block, Int3 cell, double weight,
                      std::span<ExactSum> sums) const {
  if (!fields.is_fluid(block, cell)) return;
  lbm::MomentsByRow moments(fields, block, cell.x, cell.x + 1);
  const lbm::Moments m = moments(cell);
  int k = 0;
  sums[k++].add(weight);
  for (const Field field : spec_.quantities)
    if (field == Field::velocity)
      for (const double u : fields.velocity(m)) sums[k++].add(weight * u);
    else
      sums[k++].add(weight * scalar_of(fields, field, m));
}

/// Adds this rank's terms of a point from the cells of a level.
void Probes::add(const FluidFields& fields, const Vec3& point, std::span<ExactSum> sums) const {
  const Vec3 x = point / fields.width();
  Int3 own, low;
  for (int d = 0; d < 3; ++d) {
    own[d] = std::min(int(x[d]), fields.domain().cells()[d] - 1);
    low[d] = int(std::floor(x[d] - 0.5));
  }
  with_cell(fields, own, [&](int, Int3) { sums[0].add(fields.level() + 1); });
  for_cells(low, low + Int3{2, 2, 2}, [&](Int3 cell) {
    double weight = 1;
    for (int d = 0; d < 3; ++d) weight *= 1 - std::abs(x[d] - (cell[d] + 0.5));
    if (weight <= 0) return;
    with_cell(fields, cell, [&](int b, Int3 local) {
      add_cell(fields, b, local, weight, sums.subspan(1 + fields.level() * terms()));
    });
  });
}

void Probes::look(const Simulation& simulation) {
  finish(simulation.setup());
  const Flow& flow = *simulation.scene().flow;
  levels_ = flow.levels();
  step_ = simulation.steps_done();
  const std::size_t width = 1 + levels_ * terms();
  std::vector<ExactSum> sums(width * spec_.points.size());
  flow.for_levels([&](const FluidFields& fields) {
    for (std::size_t p = 0; p < spec_.points.size(); ++p)
      add(fields, spec_.points[p], std::span(sums).subspan(p * width, width));
  });
  sums_.start(simulation.scene().comm, std::move(sums));
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

/// Makes rows of the last look, if one is not finished.
void Probes::finish(const Case& setup) {
  if (levels_ == 0) return;
  const std::vector<ExactSum>& sums = sums_.finish();
  const Units& units = setup.units;
  const std::size_t width = 1 + levels_ * terms();
  const std::vector<std::string> places = this->places(setup);
  std::string& text = rows_.text;
  for (std::size_t p = 0; p < spec_.points.size(); ++p) {
    const ExactSum* at = &sums[p * width];
    const auto level = std::size_t(at->value()) - 1;
    at += 1 + level * terms();
    const double weight = (at++)->value();
    text += fmt::format("{},{},{}", step_, double(step_) * units.time_step, places[p]);
    for (const Field field : spec_.quantities)
      for (int k = 0; k < numbers_of(field); ++k)
        text += ',' + csv_number(units.physical((at++)->value() / weight, dimension_of(field)));
    text += '\n';
  }
  rows_.last_step = step_;
  levels_ = 0;
}

}  // namespace silt::coupler
