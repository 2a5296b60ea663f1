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

/// The lattice units of a run in those of the run from which it starts.
struct Scales {
  double step = 1, density = 1;  // in units of the earlier run
  double off_equilibrium = 1;    // of populations, at equal strain rate
  bool keep_fluid() const { return step == 1 && density == 1 && off_equilibrium == 1; }
};

Scales scales_of(const CheckpointReader& reader, const Case& setup) {
  if (!reader.has("start.cell_size"))
    reader.refuse("it does not say of what run it is; let a new one write it");
  const auto positive = [&](const char* name) {
    const double value = reader.number(name);
    if (!(value > 0 && std::isfinite(value)))
      reader.refuse(fmt::format("{} is {}; it must be a number above 0", name, value));
    return value;
  };
  if (const double width = positive("start.cell_size"); width != setup.units.cell_size)
    reader.refuse_case(fmt::format("its cells are {} wide, those of the case {}; they must be of one size",
                                   width, setup.units.cell_size));
  Scales scales;
  scales.step = setup.units.time_step / positive("start.time_step");
  scales.density = setup.units.density / positive("start.density");
  if (setup.fluid && reader.has("start.relaxation_time"))
    scales.off_equilibrium = scales.step * setup.fluid->relaxation_time / positive("start.relaxation_time");
  return scales;
}

/// Returns a body with the properties of an entry and the motion of a body of the other run.
BodyRecord body_from(const BodyRecord& was, BodySpec body, const CentredShape& shape, const Scales& scales,
                     const Case& setup) {
  const double size = Eigen::Map<const rigid::Mat3>(was.inertia_B).trace() / was.mass;
  if (std::abs(size * shape.volume / shape.inertia.trace() - 1) > 1e-6)
    throw std::runtime_error(fmt::format("body {} has not the shape that the case gives '{}'", was.id,
                                         setup.kind_names[body.kind]));
  for (int d = 0; d < 3; ++d)
    if (!(was.position[d] >= 0 && was.position[d] <= setup.cells[d]))
      throw std::runtime_error(
          fmt::format("body {} is at [{:.6g}, {:.6g}, {:.6g}] cells, outside of the {} x {} x {} cells of "
                      "the case; enlarge domain.size",
                      was.id, was.position[0], was.position[1], was.position[2], setup.cells[0],
                      setup.cells[1], setup.cells[2]));
  const double* const q = was.orientation;
  body.pose = {Vec3(was.position), {q[0], q[1], q[2], q[3]}};
  body.unit = true;
  if (body.motion == rigid::Motion::free) {
    body.velocity = scales.step * Vec3(was.velocity);
    body.angular_velocity = scales.step * Vec3(was.angular_velocity);
  }
  BodyRecord r = body_record(was.id, body, shape, setup.fluid.has_value());
  std::copy_n(was.image, 3, r.image);
  coupler::coupling_of(r.attached_state).mapped =
      coupler::coupling_of(was.attached_state).mapped.pose();  // at rest there
  return r;
}

/// Returns the bodies of the other run as those of the case.
SavedState state_from(const CheckpointReader& reader, const Case& setup, const Scales& scales) {
  std::vector<std::string> kinds;
  std::istringstream names(reader.text("start.kinds"));
  for (std::string name; std::getline(names, name);) kinds.push_back(name);
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
                       [&](const BodySpec& body) { return setup.kind_names[body.kind] == name; });
      if (entry == setup.continued.end())
        throw std::runtime_error(
            fmt::format("{}: it has bodies '{}', of which the case has no entry; give [[bodies]] "
                        "of that name without positions",
                        reader.path().string(), name));
      state.bodies.records.push_back(body_from(was, *entry, shapes[entry->shape], scales, setup));
    }
  });
  state.bodies.impulses.resize(state.bodies.records.size());
  return state;
}

bool takes_fluid(const CheckpointReader& reader, const Case& setup) {
  return setup.fluid && reader.has_cells("populations");
}

/// Rescales populations: velocity, pressure and strain rate are unchanged in units of the case.
void rescale(coupler::FluidFields& fields, const Scales& scales) {
  const double pressure = scales.step * scales.step / scales.density;
  for (int b = 0; b < fields.blocks(); ++b) {
    lbm::CellBox plane{{}, {fields.block(b).size.x, fields.block(b).size.y, 1}};
    std::array<std::vector<double>, lbm::D3Q19::directions> g;
    for (; plane.lower.z < fields.block(b).size.z; ++plane.lower.z) {
      for (int i = 0; i < lbm::D3Q19::directions; ++i) {
        g[i].resize(std::size_t(plane.cells()));
        fields.read(b, plane, i, g[i].data());
      }
      for (std::size_t n = 0; n < g[0].size(); ++n) {
        double rho = 0, j[3] = {};
        for (int i = 0; i < lbm::D3Q19::directions; ++i) {
          rho += g[i][n];
          for (int d = 0; d < 3; ++d) j[d] += lbm::D3Q19::c[i][d] * g[i][n];
        }
        const double scaled[3] = {scales.step * j[0], scales.step * j[1], scales.step * j[2]};
        for (int i = 0; i < lbm::D3Q19::directions; ++i)
          g[i][n] = lbm::equilibrium(i, pressure * rho, scaled) +
                    scales.off_equilibrium * (g[i][n] - lbm::equilibrium(i, rho, j));
      }
      for (int i = 0; i < lbm::D3Q19::directions; ++i) fields.write(b, plane, i, g[i].data());
    }
  }
}

}  // namespace

void write_origin_of_start(adapters::CheckpointWriter& writer, const Case& setup, std::int64_t step) {
  std::string kinds;
  for (const std::string& name : setup.kind_names) kinds += name + '\n';
  writer.set("start.kinds", kinds);
  writer.set("start.walls", walls_after(setup, step));
  writer.set("start.cell_size", setup.units.cell_size);
  writer.set("start.time_step", setup.units.time_step);
  writer.set("start.density", setup.units.density);
  if (setup.fluid) writer.set("start.relaxation_time", setup.fluid->relaxation_time);
}

SavedState start_from(const CheckpointReader& reader, const Case& setup) {
  const Scales scales = scales_of(reader, setup);
  if (takes_fluid(reader, setup) && reader.text("start.walls") != walls_after(setup, 0))
    reader.refuse_case(
        "its [[walls]] are not where those of the case begin, and what fluid is there is not known");
  if (takes_fluid(reader, setup))
    if (const std::string fault = fault_of_populations(reader, setup); !fault.empty())
      reader.refuse_case(fault);
  SavedState state = state_from(reader, setup, scales);
  require_room_beside(state.bodies.records, reader.text("start.walls") != walls_after(setup, 0), setup,
                      coupler::make_domain(setup, parallel::ranks_of(reader.comm())), reader.comm());
  return state;
}

void find_idle_keys_at_start(const CheckpointReader& reader, const Case& setup,
                             std::vector<Diagnostic>& warnings) {
  if (takes_fluid(reader, setup) && setup.places.count("fluid.initial"))
    warnings.push_back({Diagnostic::Severity::warning, setup.place("fluid.initial"),
                        "fluid.initial has no effect: initial.from has a fluid, with which the run begins; "
                        "remove it"});
}

std::unique_ptr<Simulation> simulation_from(const CheckpointReader& reader, Case setup, MPI_Comm comm) {
  const SavedState state = start_from(reader, setup);
  const Scales scales = scales_of(reader, setup);
  std::function<void(const Case&, coupler::Flow&)> set_populations;
  if (takes_fluid(reader, setup))
    set_populations = [&](const Case& of, coupler::Flow& flow) {
      read_populations(reader, of, flow);
      if (!scales.keep_fluid()) rescale(flow.fields(), scales);
    };
  return std::make_unique<Simulation>(std::move(setup), comm, state, set_populations);
}

}  // namespace silt
