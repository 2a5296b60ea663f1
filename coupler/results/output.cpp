#include "coupler/results/output.hpp"

#include <algorithm>
#include <cmath>

#include "adapters/hdf5/field_file.hpp"
#include "coupler/case/case.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/for_each_cell.hpp"
#include "coupler/results/tessellation.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::Vec3;

/// SolidVelocities gives solid cells the velocity of the body they belong to, at its pose when the cells were
/// last mapped.
class SolidVelocities {
 public:
  explicit SolidVelocities(const Simulation& simulation)
      : bodies_(simulation.bodies()),
        world_(simulation.scene().world),
        extent_(simulation.scene().exchange->extent()) {}

  /// Fills the solid cells of a block: out is [cell][3], x fastest.
  void fill(const Flow& flow, int b, double scale, double* out) const {
    for (std::size_t row = 0; row < bodies_.first_wall(); ++row)
      for (int image = 0; image < 27; ++image) fill_image(flow, b, row, image, scale, out);
  }

 private:
  void fill_image(const Flow& flow, int b, std::size_t row, int image, double scale, double* out) const {
    const rigid::Image periods{std::int8_t(image % 3 - 1), std::int8_t(image / 3 % 3 - 1),
                               std::int8_t(image / 9 - 1)};
    if ((periods.x && !extent_.periodic[0]) || (periods.y && !extent_.periodic[1]) ||
        (periods.z && !extent_.periodic[2]))
      return;
    const rigid::Shape& shape = world_.shapes[bodies_.shape[row]];
    rigid::Pose pose = mapping_pose(bodies_, row);
    pose.position += extent_.shift(periods);
    const rigid::BoundingBox reach = rigid::bounding_box(shape, pose);
    const lbm::CellBox& box = flow.block(b);
    lbm::Int3 first, last;
    for (int d = 0; d < 3; ++d) {
      first[d] = std::max(0, int(std::floor(reach.lower[d])) - box.lower[d]);
      last[d] = std::min(box.size[d], int(std::ceil(reach.upper[d])) - box.lower[d]);
    }
    for (int z = first.z; z < last.z; ++z)
      for (int y = first.y; y < last.y; ++y)
        for (int x = first.x; x < last.x; ++x) {
          const lbm::Int3 cell{x, y, z}, global = box.lower + cell;
          const Vec3 centre(global.x + 0.5, global.y + 0.5, global.z + 0.5);
          if (flow.is_fluid(b, cell) || !rigid::contains(shape, pose.to_body(centre))) continue;
          const Vec3 u = scale * bodies_.velocity_at(row, centre - pose.position);
          std::copy_n(u.data(), 3, out + 3 * ((std::size_t(z) * box.size.y + y) * box.size.x + x));
        }
  }

  const rigid::BodySet& bodies_;
  const rigid::World& world_;
  const rigid::Extent& extent_;
};

template <class Value>
void for_block(const Flow& flow, int b, Value&& value) {
  const lbm::Int3 n = flow.block(b).size;
  std::size_t i = 0;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) value(lbm::Int3{x, y, z}, i++);
}

adapters::FieldQuantity velocity_field(const Simulation& simulation) {
  const Flow& flow = *simulation.scene().flow;
  const Units& units = simulation.setup().units;
  const double scale = units.scale(dimension::velocity);
  return {"velocity", units.si ? "m/s" : "cells/step", 3,
          [&simulation, &flow, scale](std::size_t box, double* out) {
            const int b = static_cast<int>(box);
            for_block(flow, b, [&](lbm::Int3 cell, std::size_t i) {
              std::array<double, 3> u{};
              if (flow.is_fluid(b, cell)) u = flow.velocity(flow.moments(b, cell));
              for (int d = 0; d < 3; ++d) out[3 * i + d] = scale * u[d];
            });
            SolidVelocities(simulation).fill(flow, b, scale, out);
          },
          false};
}

adapters::FieldQuantity density_field(const Simulation& simulation) {
  const Flow& flow = *simulation.scene().flow;
  const Units& units = simulation.setup().units;
  const double scale = units.scale(dimension::density);
  return {"density", units.si ? "kg/m3" : "reference densities", 1,
          [&flow, scale](std::size_t box, double* out) {
            const int b = static_cast<int>(box);
            for_block(flow, b, [&](lbm::Int3 cell, std::size_t i) {
              out[i] = scale * (flow.is_fluid(b, cell) ? 1 + flow.moments(b, cell).density_deviation : 1.0);
            });
          },
          false};
}

std::array<double, 3> scaled(const Vec3& v, double scale) {
  return {scale * v[0], scale * v[1], scale * v[2]};
}

/// Describes each kind by its first entry (the entries of a kind have the same shape).
adapters::BodySeriesInfo series_info(const Case& scene, const rigid::World& world) {
  adapters::BodySeriesInfo info;
  const double cell = scene.units.cell_size;
  for (int d = 0; d < 3; ++d) info.domain_upper[d] = scene.cells[d] * cell;
  if (scene.units.si) {
    info.length = std::string("m");
    info.time = std::string("s");
    info.mass = std::string("kg");
  }
  info.kinds.resize(scene.kind_names.size());
  const auto describe = [&](int kind, int shape, double density) {
    adapters::BodyKind& k = info.kinds[kind];
    if (!k.parts.empty()) return;
    k.name = scene.kind_names[kind];
    k.bounding_radius = cell * world.bounding_radii[shape];
    k.density = scene.units.physical(density, dimension::density);
    for (const rigid::Part& part : rigid::convex_parts(world.shapes[shape]))
      k.parts.push_back(tessellation(part, cell));
    if (const auto* mesh = std::get_if<rigid::Mesh>(&world.shapes[shape]))
      k.parts.push_back(tessellation(*mesh->surface, cell));
  };
  scene.for_each_given(
      [&](const BodySpec& body, std::uint64_t) { describe(body.kind, body.shape, body.density); });
  for (const FillSpec& fill : scene.fills) describe(fill.kind, fill.shape, fill.density);
  return info;
}

adapters::BodyRow body_row(const rigid::BodySet& bodies, std::size_t row, const BodyLoad& load,
                           const Units& units) {
  const rigid::Quat& q = bodies.orientation[row];
  adapters::BodyRow r;
  r.id = bodies.id[row];
  r.kind = bodies.kind[row];
  r.image = bodies.image[row];
  r.position = scaled(bodies.position[row], units.scale(dimension::length));
  r.orientation = {q.w(), q.x(), q.y(), q.z()};
  r.velocity = scaled(bodies.velocity[row], units.scale(dimension::velocity));
  r.angular_velocity = scaled(bodies.angular_velocity[row], units.scale(dimension::angular_velocity));
  r.force = scaled(load.force, units.scale(dimension::force));
  r.torque = scaled(load.torque, units.scale(dimension::torque));
  return r;
}

}  // namespace

std::vector<adapters::CellBox> boxes_of(const Flow* flow) {
  std::vector<adapters::CellBox> boxes;
  for (int b = 0; flow && b < flow->blocks(); ++b) {
    const lbm::CellBox& box = flow->block(b);
    const lbm::Int3 upper = box.lower + box.size;
    boxes.push_back({{box.lower.x, box.lower.y, box.lower.z}, {upper.x, upper.y, upper.z}});
  }
  return boxes;
}

void write_flow_fields(const Simulation& simulation, const std::filesystem::path& folder,
                       const adapters::Provenance& provenance) {
  const Case& scene = simulation.setup();
  const double cell = scene.units.cell_size;
  adapters::FieldSnapshot snapshot;
  snapshot.grid.cells = scene.cells;
  snapshot.grid.spacing = {cell, cell, cell};
  if (scene.units.si) {
    snapshot.grid.length_unit = std::string("m");
    snapshot.grid.time_unit = std::string("s");
  }
  for (const Field field : scene.output.quantities)
    snapshot.quantities.push_back(field == Field::density ? density_field(simulation)
                                                          : velocity_field(simulation));
  snapshot.step = simulation.steps_done();
  snapshot.time = static_cast<double>(snapshot.step) * scene.units.time_step;
  adapters::write_fields(simulation.scene().comm, adapters::field_path(folder, snapshot.step),
                         boxes_of(simulation.scene().flow.get()), snapshot, provenance);
}

BodyOutput::BodyOutput(const Simulation& simulation, const std::filesystem::path& folder,
                       const adapters::Provenance& provenance, bool resumed) {
  const MPI_Comm comm = simulation.scene().comm;
  const auto path = folder / "bodies.h5";
  int there = resumed && std::filesystem::exists(path);
  MPI_Bcast(&there, 1, MPI_INT, 0, comm);
  if (there)
    series_ = adapters::BodySeries::open_for_append(comm, path, simulation.steps_done());
  else
    series_ = adapters::BodySeries::create(
        comm, path, series_info(simulation.setup(), simulation.scene().world), provenance);
}

void BodyOutput::append(const Simulation& simulation) {
  const rigid::BodySet& bodies = simulation.bodies();
  const Units& units = simulation.setup().units;
  const auto loads = simulation.last_loads();
  const std::int64_t step = simulation.steps_done();
  series_->append(step, static_cast<double>(step) * units.time_step, bodies.owned,
                  [&](std::size_t row) { return body_row(bodies, row, loads[row], units); });
}

}  // namespace silt::coupler
