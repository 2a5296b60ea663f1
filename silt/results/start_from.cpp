#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "coupler/exchange/coupling_state.hpp"
#include "coupler/flow.hpp"
#include "coupler/spec/counter_random.hpp"
#include "lbm/fluid.hpp"
#include "parallel/together.hpp"
#include "silt/case/case.hpp"
#include "silt/placement/place_bodies.hpp"
#include "silt/results/checkpoint.hpp"

namespace silt {

namespace {

using adapters::CheckpointReader;
using rigid::BodyRecord;
using rigid::Vec3;

/// Returns the places of walls after `step` steps as a text.
std::string walls_after(const Case& setup, std::int64_t step) {
  std::string text;
  const auto add = [&](const auto& wall) {
    const rigid::Pose pose = wall.pose(double(step));
    const Vec3 x = pose.position, turn = pose.orientation.vec();
    text += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", x[0], x[1], x[2], turn[0], turn[1],
                        turn[2]);
  };
  for (const CurvedWall& wall : setup.walls) std::visit(add, wall.surface);
  return text;
}

bool takes_fluid(const CheckpointReader& reader, const Case& setup) {
  return setup.fluid && reader.has_cells("populations");
}

double positive(const CheckpointReader& reader, const char* name) {
  const double value = reader.number(name);
  if (!(value > 0 && std::isfinite(value)))
    reader.refuse(fmt::format("{} is {}; it must be a number above 0", name, value));
  return value;
}

/// The lattice units of a run in those of the run from which it starts.
struct Scales {
  double length = 1, step = 1, density = 1;  // in those of the earlier run
  double off_equilibrium = 1;                // of the populations: what keeps the rate of strain
  std::optional<HeatScales> heat;            // none: not both runs have [heat]
  bool keep_fluid() const {
    return step == 1 && density == 1 && off_equilibrium == 1 &&
           (!heat || (heat->shift == 0 && heat->off_equilibrium == 1));
  }
  double velocity() const { return step / length; }
  FluidScales of_fluid() const {
    return {length, velocity(), velocity() * velocity() / density, off_equilibrium, heat};
  }
};

std::optional<HeatScales> heat_scales_of(const CheckpointReader& reader, const Case& setup, double length) {
  if (!setup.heat || !takes_fluid(reader, setup) || !has_temperature(reader)) return {};
  if (!reader.has("start.heat_relaxation_time"))
    reader.refuse("it does not say what its temperatures are relative to; let a new one write it");
  const double reference = reader.number("start.reference_temperature");
  if (!std::isfinite(reference)) reader.refuse("its reference temperature is not a number");
  return HeatScales{reference - setup.heat->reference,
                    length * setup.heat->relaxation_time() / positive(reader, "start.heat_relaxation_time")};
}

Scales scales_of(const CheckpointReader& reader, const Case& setup) {
  if (!reader.has("start.cell_size"))
    reader.refuse("it does not say of what run it is; let a new one write it");
  Scales scales;
  scales.length = setup.units.cell_size / positive(reader, "start.cell_size");
  scales.step = setup.units.time_step / positive(reader, "start.time_step");
  scales.density = setup.units.density / positive(reader, "start.density");
  if (setup.fluid && reader.has("start.relaxation_time"))
    scales.off_equilibrium =
        scales.step * setup.fluid->relaxation_time / positive(reader, "start.relaxation_time");
  scales.heat = heat_scales_of(reader, setup, scales.length);
  return scales;
}

/// Returns the shape of an entry that a body of the other run has, by its size.
int shape_of(const BodyRecord& was, const ContinuedSpec& entry, const std::vector<CentredShape>& shapes,
             double length, const Case& setup) {
  const double size = Eigen::Map<const rigid::Mat3>(was.inertia_B).trace() / was.mass / (length * length);
  for (const FillSize& one : entry.sizes)
    if (const CentredShape& shape = shapes[one.shape];
        std::abs(size * shape.volume / shape.inertia.trace() - 1) <= 1e-6)
      return one.shape;
  throw std::runtime_error(fmt::format("body {} has not the shape that the case gives '{}'{}", was.id,
                                       setup.kind_names[entry.kind],
                                       entry.sizes.size() > 1 ? ", nor one of its sizes" : ""));
}

/// The body of an entry in the place of one of the other run.
BodyRecord body_from(const BodyRecord& was, const ContinuedSpec& entry,
                     const std::vector<CentredShape>& shapes, const Scales& scales, const Case& setup) {
  BodySpec body = entry;
  body.shape = shape_of(was, entry, shapes, scales.length, setup);
  const CentredShape& shape = shapes[body.shape];
  const Vec3 shift = setup.start->position, x = Vec3(was.position) / scales.length + shift;
  for (int d = 0; d < 3; ++d)
    if (!(x[d] >= 0 && x[d] <= setup.cells[d]))
      throw std::runtime_error(
          fmt::format("body {} is at [{:.6g}, {:.6g}, {:.6g}] cells, outside of the {} x {} x {} cells of "
                      "the case; enlarge domain.size",
                      was.id, x[0], x[1], x[2], setup.cells[0], setup.cells[1], setup.cells[2]));
  const double* const q = was.orientation;
  body.pose = {x, {q[0], q[1], q[2], q[3]}};
  body.unit = true;
  if (body.motion == rigid::Motion::free) {
    body.velocity = scales.velocity() * Vec3(was.velocity);
    body.angular_velocity = scales.step * Vec3(was.angular_velocity);
  }
  BodyRecord r = body_record(was.id, body, shape, setup.fluid.has_value());
  std::copy_n(was.image, 3, r.image);
  coupler::coupling_of(r.attached_state).mapped =  // at rest there
      scales.length == 1 && shift.isZero(0) ? coupler::coupling_of(was.attached_state).mapped.pose()
                                            : body.pose;
  return r;
}

/// Returns the temperature of a body less the reference: what it had, if it had one and may change it.
double temperature_from(const BodyRecord& was, bool was_warm, const coupler::HeatSpec& heat, int kind,
                        const std::optional<HeatScales>& scales) {
  if (!scales || !was_warm || heat.kinds[kind].capacity == 0) return heat.at_start(kind);
  return coupler::coupling_of(was.attached_state).temperature.numbers[0] + scales->shift;
}

/// Returns the bodies of the other run as those of the case.
SavedState state_from(const CheckpointReader& reader, const Case& setup, const Scales& scales) {
  const std::vector<std::string> kinds = split_lines(reader.text("start.kinds"));
  const auto warm = split_lines(scales.heat ? reader.text("start.warm_kinds") : "");
  const auto shapes = centred_shapes(setup);
  auto bodies = reader.bodies(saved_columns());
  SavedState state;
  state.is_start = true;
  state.next_id = static_cast<rigid::BodyId>(reader.integer("next_id"));
  parallel::together(reader.comm(), [&] {
    for (const BodyRecord& was : bodies.records) {
      const std::string name = was.kind >= 0 && std::size_t(was.kind) < kinds.size() ? kinds[was.kind] : "";
      const auto entry =
          std::find_if(setup.continued.begin(), setup.continued.end(),
                       [&](const ContinuedSpec& body) { return setup.kind_names[body.kind] == name; });
      if (entry == setup.continued.end())
        throw std::runtime_error(
            fmt::format("{}: it has bodies '{}', of which the case has no entry; give [[bodies]] "
                        "of that name without positions",
                        reader.path().string(), name));
      BodyRecord& body = state.bodies.records.emplace_back(body_from(was, *entry, shapes, scales, setup));
      if (setup.heat)
        coupler::coupling_of(body.attached_state).temperature.numbers[0] =
            temperature_from(was, std::ranges::count(warm, name) > 0, *setup.heat, body.kind, scales.heat);
    }
  });
  state.bodies.impulses.resize(state.bodies.records.size());
  return state;
}

/// Returns whether the walls of the other run, whose cells may be of another width, end where those begin.
bool has_same_walls(const CheckpointReader& reader, const Case& setup, double length) {
  constexpr double rounding = 1e-6;
  const std::string there = reader.text("start.walls"), here = walls_after(setup, 0);
  if (length == 1) return there == here;
  std::istringstream was(there), is(here);
  double x = 0, y = 0;
  for (int k = 0;; ++k) {
    const bool more = bool(was >> x);
    if (bool(is >> y) != more) return false;
    if (!more) return true;
    if (std::abs(x - (k % 6 < 3 ? length : 1) * y) > rounding * std::max(1., std::abs(x))) return false;
  }
}

/// Throws where the fluid cannot be that of the case: on the same cells bit by bit, on others in the same
/// domain.
void require_fluid(const CheckpointReader& reader, const Case& setup, double length) {
  if (!has_same_walls(reader, setup, length))
    reader.refuse_case(
        "its [[walls]] are not where those of the case begin, and what fluid is there is not known");
  if (length == 1) {
    if (const std::string fault = fault_of_populations(reader, setup); !fault.empty())
      reader.refuse_case(fault);
    return;
  }
  const auto n = reader.lattice("populations");
  for (int d = 0; d < 3; ++d)
    if (std::abs(n[d] - length * setup.cells[d]) > 1e-6 * n[d])
      reader.refuse_case(
          fmt::format("its domain has {} x {} x {} cells, each as wide as {:.6g} of the case, which has "
                      "{} x {} x {}; the domains must be of one size",
                      n[0], n[1], n[2], 1 / length, setup.cells[0], setup.cells[1], setup.cells[2]));
  if (!has_temperature(reader) && reader.components("populations") != lbm::D3Q19::directions)
    reader.refuse_case("its populations are of another lattice than the case's");
  if (!reader.has("start.surfaces"))
    reader.refuse_case(
        "it does not say which of its cells are solid, and those of the case are of another width; let "
        "a new one write it");
}

}  // namespace

void write_origin_of_start(adapters::CheckpointWriter& writer, const Case& setup, std::int64_t step) {
  writer.set("start.kinds", joined_lines(setup.kind_names));
  writer.set("start.walls", walls_after(setup, step));
  writer.set("start.surfaces", std::int64_t{setup.has_surfaces()});  // then /cells/solid is there
  writer.set("start.cell_size", setup.units.cell_size);
  writer.set("start.time_step", setup.units.time_step);
  writer.set("start.density", setup.units.density);
  if (setup.fluid) writer.set("start.relaxation_time", setup.fluid->relaxation_time);
  if (!setup.heat) return;
  std::string warm;
  for (std::size_t k = 0; k < setup.kind_names.size(); ++k)
    if (setup.heat->kinds[k].temperature) warm += setup.kind_names[k] + '\n';
  writer.set("start.warm_kinds", warm);  // those of a temperature
  writer.set("start.reference_temperature", setup.heat->reference);
  writer.set("start.heat_relaxation_time", setup.heat->relaxation_time());
}

SavedState start_from(const CheckpointReader& reader, const Case& setup) {
  const Scales scales = scales_of(reader, setup);
  const bool shifted = !setup.start->position.isZero(0);
  if (takes_fluid(reader, setup)) {
    if (shifted) reader.refuse_case("it has a fluid, which initial.position cannot shift");
    require_fluid(reader, setup, scales.length);
  }
  SavedState state = state_from(reader, setup, scales);
  require_room_beside(state.bodies.records, shifted || !has_same_walls(reader, setup, scales.length), setup,
                      coupler::make_domain(setup, parallel::ranks_of(reader.comm())), reader.comm());
  return state;
}

void find_idle_keys_at_start(const CheckpointReader& reader, const Case& setup,
                             std::vector<Diagnostic>& warnings) {
  const auto tell = [&](bool is_there, const char* key, const char* what) {
    if (is_there && setup.places.count(key))
      warnings.push_back({Diagnostic::Severity::warning, setup.place(key),
                          fmt::format("{} has no effect: initial.from has {}, with which the run begins; "
                                      "remove it",
                                      key, what)});
  };
  tell(takes_fluid(reader, setup), "fluid.initial", "a fluid");
  tell(takes_fluid(reader, setup) && has_temperature(reader), "heat.initial", "a temperature");
}

std::unique_ptr<Simulation> simulation_from(const CheckpointReader& reader, Case setup, MPI_Comm comm) {
  const SavedState state = start_from(reader, setup);
  const Scales scales = scales_of(reader, setup);
  std::function<void(const Case&, coupler::Flow&)> set_populations;
  if (takes_fluid(reader, setup))
    set_populations = [&](const Case& of, coupler::Flow& flow) {
      if (scales.length != 1)
        interpolate_populations(reader, of, flow.fields(), scales.of_fluid());
      else
        read_populations(reader, of, flow);
      if (scales.length == 1 && !scales.keep_fluid()) rescale_populations(flow.fields(), scales.of_fluid());
      if (!scales.heat) set_initial_temperature(of, flow.fields());
    };
  return std::make_unique<Simulation>(std::move(setup), comm, state, set_populations);
}

}  // namespace silt
