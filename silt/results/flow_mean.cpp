#include "silt/results/flow_mean.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "parallel/together.hpp"
#include "silt/case/case.hpp"
#include "silt/results/definitions.hpp"
#include "silt/results/flow_fields.hpp"
#include "silt/results/solid_cells.hpp"

namespace silt {

using lbm::Int3;

FlowMean::FlowMean(const Simulation& simulation) : spec_(*simulation.setup().output.mean) {
  const coupler::FluidFields& fields = simulation.scene().flow->fields();
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::CellBox& box = fields.block(b);
    const std::int64_t cells = box.cells();
    blocks_.push_back({cells, cells / box.size.z, std::vector<double>(std::size_t(numbers * cells))});
  }
}

void FlowMean::observe(const Simulation& simulation) {
  const auto step = double(simulation.steps_done());
  if (step < spec_.from || simulation.steps_done() % spec_.every != 0) return;
  ++samples_;
  const coupler::FluidFields& fields = simulation.scene().flow->fields();
  const SolidCells solid(simulation, fields);
  for (int b = 0; b < fields.blocks(); ++b) {
    const Int3 size = fields.block(b).size;
    lbm::MomentsByRow moments(fields, b, 0, size.x);
    double* const block = blocks_[b].values.data();
    const std::int64_t cells = blocks_[b].cells;
    std::int64_t n = -1;
    coupler::for_cells({}, size, [&](Int3 x) {
      ++n;
      if (!fields.is_fluid(b, x)) return;
      double* const of = block + n;
      const lbm::Moments m = moments(x);
      const auto u = fields.velocity(m);
      const double times = of[count * cells] += 1;
      double before[3], after[3];
      for (int d = 0; d < 3; ++d) {
        double& mean = of[(velocity + d) * cells];
        before[d] = u[d] - mean;
        mean += before[d] / times;
        after[d] = u[d] - mean;
      }
      constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
      for (int k = 0; k < 6; ++k) of[(products + k) * cells] += before[pairs[k][0]] * after[pairs[k][1]];
      double& mean = of[density * cells];
      mean += (m.density_deviation - mean) / times;
    });
    const Piece all{b, {}, size};
    solid.for_each(all, [&](std::size_t row, Int3 x, const rigid::Vec3& r) {
      double* const of = block + all.index(x);
      const rigid::Vec3 u = simulation.bodies().velocity_at(row, r);
      const double times = double(samples_) - of[count * cells];
      for (int d = 0; d < 3; ++d)
        of[(body_velocity + d) * cells] += (u[d] - of[(body_velocity + d) * cells]) / times;
    });
  }
}

/// Returns the arrays from `first` on as a field, of products the mean; 0 in cells that were never fluid.
adapters::FieldQuantity FlowMean::quantity(const char* name, const char* unit, double scale, int first,
                                           int components, bool of_products) const {
  return {name, unit, components,
          [this, scale, first, components, of_products](std::size_t b, int begin, int end, double* out) {
            const Block& block = blocks_[b];
            const std::int64_t plane = blocks_[b].of_a_plane;
            for (std::int64_t n = begin * plane; n < end * plane; ++n)
              for (int k = 0; k < components; ++k) {
                const double x = block.array(first + k)[n], times = block.array(count)[n];
                *out++ = scale * (of_products && times > 0 ? x / times : x);
              }
          },
          adapters::Storage::double_};
}

void FlowMean::write(const Simulation& simulation, const std::filesystem::path& folder,
                     const adapters::Provenance& provenance) const {
  if (samples_ == 0) return;
  const Case& setup = simulation.setup();
  const Units& units = setup.units;
  FieldsSpec all;
  all.upper = setup.cells;
  adapters::FieldSnapshot snapshot = snapshot_of(simulation, all, false);
  const double u = units.scale(dimension::velocity);
  const char* const square = units.si ? "m2/s2" : "cells2/step2";
  snapshot.quantities = {
      quantity("velocity", units.si ? "m/s" : "cells/step", u, velocity, 3, false),
      quantity("velocity-variance", square, u * u, products, 3, true),
      quantity("velocity-covariance", square, u * u, products + 3, 3, true),
      quantity("pressure", units.si ? "Pa" : "cells2/step2 reference densities",
               units.scale(dimension::pressure) / 3, density, 1, false),
      quantity("body-velocity", units.si ? "m/s" : "cells/step", u, body_velocity, 3, false),
      {"solid-fraction", "1", 1,
       [this](std::size_t b, int begin, int end, double* out) {
         const std::int64_t plane = blocks_[b].of_a_plane;
         for (std::int64_t n = begin * plane; n < end * plane; ++n)
           *out++ = 1 - blocks_[b].array(count)[n] / double(samples_);
       },
       adapters::Storage::double_}};
  const auto path = adapters::step_path(folder, "mean", snapshot.step, ".hdf");
  parallel::with_file_name(path.string(), [&] {
    adapters::write_fields(simulation.scene().comm, path, boxes_of(simulation.scene().flow->fields()),
                           snapshot, provenance);
  });
}

void FlowMean::save(adapters::CheckpointWriter& writer, const Simulation& simulation) const {
  writer.set(definition_name(flow_mean_name), definition_of(spec_));
  writer.set("mean.samples", samples_);
  writer.cells(flow_mean_name, adapters::Storage::double_, simulation.setup().cells, numbers,
               boxes_of(simulation.scene().flow->fields()), [&](int q, std::size_t b, void* out) {
                 std::copy_n(blocks_[b].array(q), blocks_[b].cells, static_cast<double*>(out));
               });
}

void FlowMean::restore(const adapters::CheckpointReader& reader, const Simulation& simulation) {
  if (!holds(reader, flow_mean_name, definition_of(spec_))) return;
  samples_ = reader.integer("mean.samples");
  const bool fits = reader.has_cells(flow_mean_name) &&
                    reader.lattice(flow_mean_name) == simulation.setup().cells &&
                    reader.components(flow_mean_name) == numbers;
  if (!fits) reader.refuse("/cells/mean is not there, or of another lattice than the case's");
  std::string fault;
  reader.cells(flow_mean_name, adapters::Storage::double_, boxes_of(simulation.scene().flow->fields()),
               [&](int q, std::size_t b, const void* in) {
                 const auto* const found = static_cast<const double*>(in);
                 std::copy_n(found, blocks_[b].cells, blocks_[b].array(q));
                 const double most = q == count ? double(samples_) : 1e300, least = q == count ? 0 : -most;
                 for (std::int64_t n = 0; n < blocks_[b].cells; ++n)
                   if (!(found[n] >= least && found[n] <= most))
                     fault = fmt::format("/cells/mean, number {}, has {}; no samples give that", q, found[n]);
               });
  parallel::together(reader.comm(), [&] {
    if (!fault.empty()) throw std::runtime_error(fault);
  });
}

}  // namespace silt
