#include "silt/results/flow_fields.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "lbm/fluid.hpp"
#include "parallel/together.hpp"
#include "silt/case/case.hpp"
#include "silt/results/lattice_of_levels.hpp"
#include "silt/results/solid_cells.hpp"
#include "silt/results/velocity_gradient.hpp"

namespace silt {

namespace {

using lbm::CellBox;
using lbm::Int3;
using rigid::Vec3;

Int3 int3(const std::array<int, 3>& x) {
  return {x[0], x[1], x[2]};
}

struct FieldForm {
  Dimension dimension;
  const char *si, *lattice;  // units
};
constexpr FieldForm forms[] = {{dimension::velocity, "m/s", "cells/step"},
                               {dimension::density, "kg/m3", "reference densities"},
                               {dimension::pressure, "Pa", "cells2/step2 reference densities"},
                               {dimension::angular_velocity, "1/s", "1/step"},
                               {dimension::none, "K", "1"},
                               {dimension::none, "1", "1"},
                               {dimension::angular_velocity, "1/s", "1/step"},
                               {dimension::none, "1", "1"}};

/// Returns the parts of this rank's blocks in a box of cells.
std::vector<Piece> pieces_of(const coupler::FluidFields& fields, const CellBox& within) {
  std::vector<Piece> pieces;
  for (int b = 0; b < fields.blocks(); ++b) {
    const CellBox here = overlap(within, fields.block(b));
    const Int3 first = here.lower - fields.block(b).lower;
    if (here.cells() > 0) pieces.push_back({b, first, first + here.size});
  }
  return pieces;
}

/// Computes the fields of one level of a simulation for the pieces of a box.
class Fields {
 public:
  /// Field values are in `units`; the box is in cells of the level.
  Fields(const Simulation& simulation, int level, const FieldsSpec& spec, const CellBox& within,
         const Units& units)
      : simulation_(simulation),
        fields_(simulation.scene().flow->fields(level)),
        units_(units),
        pieces_(pieces_of(fields_, within)),
        solid_cells_(simulation, fields_),
        storage_(spec.double_precision ? adapters::Storage::double_ : adapters::Storage::single) {
    if (std::count(spec.quantities.begin(), spec.quantities.end(), Field::vorticity))
      velocities_.emplace(fields_, simulation.scene().comm, within.lower, within.lower + within.size);
  }

  /// Returns the pieces as boxes of cells of the level.
  LevelBoxes boxes() const {
    LevelBoxes all{fields_.width(), {}};
    for (const Piece& piece : pieces_)
      all.boxes.push_back({fields_.block(piece.block).lower + piece.first, piece.last - piece.first});
    return all;
  }

  adapters::FieldQuantity quantity(Field field) const {
    switch (field) {
      case Field::velocity:
        return velocity();
      case Field::body_id:
        return body_id();
      case Field::vorticity:
        return vorticity();
      case Field::solid:
        return solid();
      case Field::temperature:
        return temperature();
      default:
        return scalar(field, field == Field::density ? 1 : 0);
    }
  }

 private:
  const char* unit(Field field) const {
    const FieldForm& form = forms[int(field)];
    return units_.si ? form.si : form.lattice;
  }
  /// Returns a field that is a function of the moments of fluid cells, with a fixed value in solid cells.
  adapters::FieldQuantity scalar(Field field, double solid) const {
    const double scale = units_.scale(dimension_of(field));
    const auto values = [this, scale, solid, field](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      const coupler::CellBits& is_solid = fields_.solid(piece.block);
      lbm::MomentsByRow moments(fields_, piece.block, piece.first.x, piece.last.x);
      piece.for_each([&](Int3 cell, std::size_t i) {
        out[i] = scale * (is_solid.test(cell) ? solid : scalar_of(fields_, field, moments(cell)));
      });
    };
    return {std::string(field_names[field]), unit(field), 1, values, storage_};
  }

  /// Returns a vector field: of_fluid(piece) gives the function for fluid cells of a piece, of_body(row, r)
  /// the value in bodies, with r from the body's centre to the cell's; zero in walls.
  template <class OfFluid, class OfBody>
  adapters::FieldQuantity vector(Field field, int width, OfFluid of_fluid, OfBody of_body) const {
    const double scale = units_.scale(dimension_of(field)) / width;
    const auto values = [this, scale, of_fluid, of_body](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      const coupler::CellBits& is_solid = fields_.solid(piece.block);
      auto of = of_fluid(piece);
      piece.for_each([&](Int3 cell, std::size_t i) {
        const Vec3 v = is_solid.test(cell) ? Vec3(Vec3::Zero()) : Vec3(scale * of(cell));
        std::copy_n(v.data(), 3, out + 3 * i);
      });
      solid_cells_.for_each(piece, [&](std::size_t row, Int3 cell, const Vec3& r) {
        const Vec3 v = scale * of_body(row, r);
        std::copy_n(v.data(), 3, out + 3 * piece.index(cell));
      });
    };
    return {std::string(field_names[field]), unit(field), 3, values, storage_};
  }

  adapters::FieldQuantity velocity() const {
    return vector(
        Field::velocity, 1,
        [this](const Piece& piece) {
          lbm::MomentsByRow moments(fields_, piece.block, piece.first.x, piece.last.x);
          return [this, moments](Int3 cell) mutable {
            const auto u = fields_.velocity(moments(cell));
            return Vec3(u[0], u[1], u[2]);
          };
        },
        [this](std::size_t row, const Vec3& r) { return simulation_.bodies().velocity_at(row, r); });
  }

  adapters::FieldQuantity vorticity() const {
    return vector(
        Field::vorticity, fields_.width(),
        [this](const Piece& piece) {
          return [around = VelocitiesAround(fields_, *velocities_, piece.block, piece.first, piece.last)](
                     Int3 cell) mutable { return silt::vorticity(around, cell); };
        },
        [this](std::size_t row, const Vec3&) {
          return Vec3(2 * simulation_.bodies().angular_velocity[row]);
        });
  }

  /// Returns the field of ids: 0 in fluid and walls; exact to 2^53.
  adapters::FieldQuantity body_id() const {
    const auto values = [this](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      piece.for_each([&](Int3, std::size_t i) { out[i] = 0; });
      solid_cells_.for_each(piece, [&](std::size_t row, Int3 cell, const Vec3&) {
        double& here = out[piece.index(cell)];  // bodies overlap: the lower id has the cell
        const double id = double(simulation_.bodies().id[row]);
        here = here > 0 ? std::min(here, id) : id;
      });
    };
    return {"body-id", "1", 1, values, adapters::Storage::double_};
  }

  /// Returns the field 0 in fluid, 1 in bodies, 2 in walls.
  adapters::FieldQuantity solid() const {
    const auto values = [this](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      const coupler::CellBits& is_solid = fields_.solid(piece.block);
      piece.for_each([&](Int3 cell, std::size_t i) { out[i] = is_solid.test(cell) ? 2 : 0; });
      solid_cells_.for_each(piece, [&](std::size_t, Int3 cell, const Vec3&) { out[piece.index(cell)] = 1; });
    };
    return {"solid", "1", 1, values, adapters::Storage::byte};
  }

  /// Returns the field of temperatures; that of reference in walls and insulating bodies.
  adapters::FieldQuantity temperature() const {
    const auto values = [this](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      const coupler::CellBits& is_solid = fields_.solid(piece.block);
      const double reference = simulation_.setup().heat->reference;
      piece.for_each([&](Int3 cell, std::size_t i) {
        out[i] = is_solid.test(cell) ? reference : fields_.temperature(piece.block, cell);
      });
      solid_cells_.for_each(piece, [&](std::size_t row, Int3 cell, const Vec3&) {
        const auto& of_body = coupler::coupling_of(simulation_.bodies(), row);
        out[piece.index(cell)] = reference + of_body.temperature.numbers[0];
      });
    };
    return {"temperature", unit(Field::temperature), 1, values, storage_};
  }

  const Simulation& simulation_;
  const coupler::FluidFields& fields_;
  const Units units_;
  std::vector<Piece> pieces_;
  SolidCells solid_cells_;
  adapters::Storage storage_;
  std::optional<CellVelocities> velocities_;  // for the vorticity
};

}  // namespace

double scalar_of(const coupler::FluidFields& fields, Field field, const lbm::Moments& m) {
  if (field == Field::density) return 1 + m.density_deviation;
  if (field == Field::pressure) return m.density_deviation / 3;
  return std::sqrt(2 * strain_rate_squared(fields, m));
}

Dimension dimension_of(Field field) {
  return forms[int(field)].dimension;
}

std::vector<CellBox> boxes_of(const coupler::FluidFields& fields) {
  std::vector<CellBox> boxes;
  for (int b = 0; b < fields.blocks(); ++b) boxes.push_back(fields.block(b));
  return boxes;
}

CellBox box_of(const coupler::Flow& flow) {
  CellBox all;
  flow.for_levels([&](const coupler::FluidFields& fields) {
    for (const CellBox& block : boxes_of(fields)) {
      const CellBox box = in_cells_of(1, block, fields.width()), before = all.cells() > 0 ? all : box;
      for (int d = 0; d < 3; ++d) {
        all.lower[d] = std::min(before.lower[d], box.lower[d]);
        all.size[d] = std::max(before.lower[d] + before.size[d], box.lower[d] + box.size[d]) - all.lower[d];
      }
    }
  });
  return all;
}

namespace {

/// The fields of all levels in a box of finest cells.
class LevelledFields {
 public:
  LevelledFields(const Simulation& simulation, const FieldsSpec& spec, const CellBox& within,
                 const Units& units)
      : within_(within) {
    simulation.scene().flow->for_levels([&](const coupler::FluidFields& fields) {
      const int level = fields.level();
      boxes_.push_back(
          levels_.emplace_back(simulation, level, spec, in_cells_of(fields.width(), within, 1), units)
              .boxes());
    });
  }

  int levels() const { return int(levels_.size()); }
  /// Returns a lattice of cells `width` finest cells wide over the boxes of levels up to `up_to`.
  LatticeOfLevels lattice(int up_to, int width) const {
    return {{boxes_.begin(), boxes_.begin() + up_to + 1}, width, in_cells_of(width, within_, 1)};
  }
  adapters::FieldQuantity quantity(const LatticeOfLevels& lattice, Field field) const {
    std::vector<adapters::FieldQuantity> of_levels;
    for (const Fields& level : levels_) of_levels.push_back(level.quantity(field));
    return lattice.quantity(std::move(of_levels));
  }

 private:
  CellBox within_;
  std::deque<Fields> levels_;  // quantities refer to them
  std::vector<LevelBoxes> boxes_;
};

}  // namespace

FieldHere field_here(const Simulation& simulation, Field field) {
  FieldsSpec all;
  all.quantities = {field};
  const LevelledFields fields(simulation, all, {{}, int3(simulation.setup().cells)}, Units{});
  const LatticeOfLevels lattice = fields.lattice(fields.levels() - 1, 1);
  const adapters::FieldQuantity quantity = fields.quantity(lattice, field);
  const std::size_t components = quantity.components;
  FieldHere here{box_of(*simulation.scene().flow), quantity.components, {}};
  here.values.assign(here.box.cells() * components, std::numeric_limits<double>::quiet_NaN());
  const Piece whole{0, here.box.lower, here.box.lower + here.box.size};
  std::vector<double> plane;
  for (std::size_t k = 0; k < lattice.boxes().size(); ++k) {
    const auto& [low, size] = lattice.boxes()[k];
    const std::size_t row = size.x * components;
    plane.resize(row * size.y);
    for (int z = 0; z < size.z; ++z) {
      quantity.values(k, z, z + 1, plane.data());
      for (int y = 0; y < size.y; ++y)
        std::copy_n(plane.data() + y * row, row,
                    here.values.data() + whole.index(low + Int3{0, y, z}) * components);
    }
  }
  return here;
}

adapters::FieldSnapshot snapshot_of(const Simulation& simulation, const FieldsSpec& spec, bool by_level) {
  const Units& units = simulation.setup().units;
  adapters::FieldSnapshot snapshot;
  for (int d = 0; d < 3; ++d) {
    snapshot.grid.cells[d] = spec.upper[d] - spec.lower[d];
    snapshot.grid.origin[d] = by_level ? 0 : spec.lower[d] * units.cell_size;
    snapshot.grid.spacing[d] = units.cell_size;
  }
  snapshot.grid.length_unit = units.unit_text(dimension::length);
  snapshot.grid.time_unit = units.unit_text(dimension::time);
  snapshot.step = simulation.steps_done();
  snapshot.time = double(snapshot.step) * units.time_step;
  snapshot.plan = {spec.every, simulation.setup().steps, units.time_step};
  return snapshot;
}

void write_flow_fields(const Simulation& simulation, const FieldsSpec& spec,
                       const std::filesystem::path& folder, const adapters::Provenance& provenance) {
  const int levels = simulation.scene().flow->levels(), widest = 1 << (levels - 1);
  const bool by_level = levels > 1;
  const Int3 lower = int3(spec.lower);
  CellBox within{lower, int3(spec.upper) - lower};
  if (by_level) within = in_cells_of(1, in_cells_of(widest, within, 1), widest);
  adapters::FieldSnapshot snapshot = snapshot_of(simulation, spec, by_level);
  const auto path = adapters::step_path(folder, spec.name, snapshot.step, ".hdf");
  const LevelledFields fields(simulation, spec, within, simulation.setup().units);
  std::deque<LatticeOfLevels> lattices;  // quantities refer to them
  const auto level_of = [&](int up_to, int width) {
    const LatticeOfLevels& lattice = lattices.emplace_back(fields.lattice(up_to, width));
    adapters::FieldLevel level{width, lattice.boxes(), {}};
    for (const Field field : spec.quantities) level.quantities.push_back(fields.quantity(lattice, field));
    return level;
  };
  if (by_level) {  // VTK needs cells of the next level below those of each
    std::vector<adapters::FieldLevel> written;
    for (int level = 0; level < levels; ++level) written.push_back(level_of(level, 1 << level));
    return parallel::with_file_name(path.string(), [&] {
      adapters::write_fields(simulation.scene().comm, path, written, snapshot, provenance);
    });
  }
  adapters::FieldLevel image = level_of(levels - 1, 1);
  for (CellBox& box : image.boxes) box.lower = box.lower - lower;
  snapshot.quantities = std::move(image.quantities);
  parallel::with_file_name(path.string(), [&] {
    adapters::write_fields(simulation.scene().comm, path, image.boxes, snapshot, provenance);
  });
}

}  // namespace silt
