#include "coupler/results/flow_fields.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapters/hdf5/field_file.hpp"
#include "coupler/case/case.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/results/velocity_gradient.hpp"
#include "lbm/fluid.hpp"
#include "parallel/together.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using lbm::Int3;
using rigid::Vec3;

/// Cells of a block that are written: [first, last), counted from the block's first.
struct Piece {
  int block;
  Int3 first, last;

  /// Calls visit(cell, i) for each cell, x fastest.
  template <class Visit>
  void for_each(Visit&& visit) const {
    std::size_t i = 0;
    for_cells(first, last, [&](Int3 cell) { visit(cell, i++); });
  }
  /// Planes [begin, end), which count from its first.
  Piece planes(int begin, int end) const {
    Piece part = *this;
    part.first.z = first.z + begin, part.last.z = first.z + end;
    return part;
  }
  std::size_t index(Int3 cell) const {
    const Int3 n = last - first, x = cell - first;
    return (std::size_t(x.z) * n.y + x.y) * n.x + x.x;
  }
};

Int3 int3(const std::array<int, 3>& x) {
  return {x[0], x[1], x[2]};
}

/// What of this rank's blocks is in a box of cells.
std::vector<Piece> pieces_of(const FluidFields& fields, const FieldsSpec& spec) {
  std::vector<Piece> pieces;
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::CellBox& box = fields.block(b);
    Piece piece{b, {}, {}};
    bool any = true;
    for (int d = 0; d < 3; ++d) {
      piece.first[d] = std::max(spec.lower[d] - box.lower[d], 0);
      piece.last[d] = std::min(spec.upper[d] - box.lower[d], box.size[d]);
      any &= piece.first[d] < piece.last[d];
    }
    if (any) pieces.push_back(piece);
  }
  return pieces;
}

/// The bodies as they were when cells were last mapped.
class SolidCells {
 public:
  explicit SolidCells(const Simulation& simulation)
      : fields_(simulation.scene().flow->fields()),
        bodies_(simulation.bodies()),
        world_(simulation.scene().world),
        extent_(simulation.scene().exchange->extent()) {
    for (std::size_t row = 0; row < bodies_.first_wall(); ++row)
      reach_.push_back(rigid::bounding_box(world_.shapes[bodies_.shape[row]], mapping_pose(bodies_, row)));
  }

  /// Calls visit(row, cell, r) for the solid cells of a piece and the bodies they lie in, r from the body's
  /// centre to that of the cell.
  template <class Visit>
  void for_each(const Piece& piece, Visit&& visit) const {
    for (std::size_t row = 0; row < reach_.size(); ++row) for_images(piece, row, 2, Vec3::Zero(), visit);
  }

 private:
  /// Narrows the piece to what images of a body reach, from this axis down: few planes meet any along z.
  template <class Visit>
  void for_images(const Piece& piece, std::size_t row, int axis, Vec3 shift, Visit&& visit) const {
    if (axis < 0) return for_image(piece, row, shift, visit);
    const int corner = fields_.block(piece.block).lower[axis], images = extent_.periodic[axis] ? 1 : 0;
    for (int image = -images; image <= images; ++image) {
      shift[axis] = image * extent_.size[axis];
      Piece part = piece;
      const rigid::BoundingBox& reach = reach_[row];
      part.first[axis] =
          std::max(part.first[axis], int(std::floor(reach.lower[axis] + shift[axis])) - corner);
      part.last[axis] = std::min(part.last[axis], int(std::ceil(reach.upper[axis] + shift[axis])) - corner);
      if (part.first[axis] < part.last[axis]) for_images(part, row, axis - 1, shift, visit);
    }
  }
  template <class Visit>
  void for_image(const Piece& piece, std::size_t row, const Vec3& shift, Visit&& visit) const {
    const Int3 corner = fields_.block(piece.block).lower;
    rigid::Pose pose = mapping_pose(bodies_, row);
    pose.position += shift;
    const rigid::Shape& shape = world_.shapes[bodies_.shape[row]];
    piece.for_each([&](Int3 cell, std::size_t) {
      const Int3 global = corner + cell;
      const Vec3 centre(global.x + 0.5, global.y + 0.5, global.z + 0.5);
      if (!fields_.is_fluid(piece.block, cell) && rigid::contains(shape, pose.to_body(centre)))
        visit(row, cell, Vec3(centre - pose.position));
    });
  }

  const FluidFields& fields_;
  const rigid::BodySet& bodies_;
  const rigid::World& world_;
  const rigid::Extent& extent_;
  std::vector<rigid::BoundingBox> reach_;  // of the rows
};

/// Makes the fields of a simulation for the pieces of a box.
class Fields {
 public:
  /// Their values are in these units.
  Fields(const Simulation& simulation, const FieldsSpec& spec, const Units& units)
      : simulation_(simulation),
        fields_(simulation.scene().flow->fields()),
        units_(units),
        pieces_(pieces_of(fields_, spec)),
        solid_cells_(simulation),
        storage_(spec.double_precision ? adapters::Storage::double_ : adapters::Storage::single) {
    if (std::count(spec.quantities.begin(), spec.quantities.end(), Field::vorticity))
      velocities_.emplace(fields_, simulation.scene().comm, int3(spec.lower), int3(spec.upper));
  }

  const std::vector<Piece>& pieces() const { return pieces_; }

  adapters::FieldQuantity quantity(Field field) const {
    switch (field) {
      case Field::velocity:
        return velocity();
      case Field::density:
        return scalar("density", units_.si ? "kg/m3" : "reference densities",
                      units_.scale(dimension::density), 1,
                      [](const lbm::Moments& m) { return 1 + m.density_deviation; });
      case Field::pressure:
        return scalar("pressure", units_.si ? "Pa" : "cells2/step2 reference densities",
                      units_.scale(dimension::pressure), 0,
                      [](const lbm::Moments& m) { return m.density_deviation / 3; });
      case Field::shear_rate:
        return scalar(
            "shear-rate", units_.si ? "1/s" : "1/step", units_.scale(dimension::angular_velocity), 0,
            [this](const lbm::Moments& m) { return std::sqrt(2 * strain_rate_squared(fields_, m)); });
      case Field::body_id:
        return body_id();
      case Field::vorticity:
        return vorticity();
      case Field::solid:
        return solid();
    }
    __builtin_unreachable();
  }

 private:
  /// A function of the moments of fluid cells; solid ones have a value of their own.
  template <class Of>
  adapters::FieldQuantity scalar(const char* name, const char* unit, double scale, double solid,
                                 Of of) const {
    const auto values = [this, scale, solid, of](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      const CellBits& is_solid = fields_.solid(piece.block);
      lbm::MomentsByRow moments(fields_, piece.block, piece.first.x, piece.last.x);
      piece.for_each([&](Int3 cell, std::size_t i) {
        out[i] = scale * (is_solid.test(cell) ? solid : of(moments(cell)));
      });
    };
    return {name, unit, 1, values, storage_};
  }

  /// of_fluid(piece) returns a function of the fluid cells of a piece; of_body(row, r) is that of cells in
  /// bodies, where r is from the body's centre to that of the cell; zero in walls.
  template <class OfFluid, class OfBody>
  adapters::FieldQuantity vector(const char* name, const char* unit, double scale, OfFluid of_fluid,
                                 OfBody of_body) const {
    const auto values = [this, scale, of_fluid, of_body](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      const CellBits& is_solid = fields_.solid(piece.block);
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
    return {name, unit, 3, values, storage_};
  }

  adapters::FieldQuantity velocity() const {
    return vector(
        "velocity", units_.si ? "m/s" : "cells/step", units_.scale(dimension::velocity),
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
        "vorticity", units_.si ? "1/s" : "1/step", units_.scale(dimension::angular_velocity),
        [this](const Piece& piece) {
          return [around = VelocitiesAround(fields_, *velocities_, piece.block, piece.first, piece.last)](
                     Int3 cell) mutable { return coupler::vorticity(around, cell); };
        },
        [this](std::size_t row, const Vec3&) {
          return Vec3(2 * simulation_.bodies().angular_velocity[row]);
        });
  }

  /// 0 in fluid and in walls. In double precision ids are exact to 2^53, in single to 2^24.
  adapters::FieldQuantity body_id() const {
    const auto values = [this](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      piece.for_each([&](Int3, std::size_t i) { out[i] = 0; });
      solid_cells_.for_each(piece, [&](std::size_t row, Int3 cell, const Vec3&) {
        double& here = out[piece.index(cell)];  // where bodies overlap the lower id has the cell
        const double id = double(simulation_.bodies().id[row]);
        here = here > 0 ? std::min(here, id) : id;
      });
    };
    return {"body-id", "1", 1, values, adapters::Storage::double_};
  }

  /// 0 in fluid, 1 in bodies, 2 in walls.
  adapters::FieldQuantity solid() const {
    const auto values = [this](std::size_t k, int begin, int end, double* out) {
      const Piece piece = pieces_[k].planes(begin, end);
      const CellBits& is_solid = fields_.solid(piece.block);
      piece.for_each([&](Int3 cell, std::size_t i) { out[i] = is_solid.test(cell) ? 2 : 0; });
      solid_cells_.for_each(piece, [&](std::size_t, Int3 cell, const Vec3&) { out[piece.index(cell)] = 1; });
    };
    return {"solid", "1", 1, values, adapters::Storage::byte};
  }

  const Simulation& simulation_;
  const FluidFields& fields_;
  const Units units_;
  std::vector<Piece> pieces_;
  SolidCells solid_cells_;
  adapters::Storage storage_;
  std::optional<CellVelocities> velocities_;  // where vorticity is asked for
};

}  // namespace

std::vector<adapters::CellBox> boxes_of(const FluidFields& fields) {
  std::vector<adapters::CellBox> boxes;
  for (int b = 0; b < fields.blocks(); ++b) {
    const lbm::CellBox& box = fields.block(b);
    const Int3 upper = box.lower + box.size;
    boxes.push_back({{box.lower.x, box.lower.y, box.lower.z}, {upper.x, upper.y, upper.z}});
  }
  return boxes;
}

adapters::CellBox box_of(const FluidFields& fields) {
  const std::vector<adapters::CellBox> boxes = boxes_of(fields);
  if (boxes.empty()) return {};
  adapters::CellBox all = boxes.front();
  for (const adapters::CellBox& box : boxes)
    for (int d = 0; d < 3; ++d) {
      all.lower[d] = std::min(all.lower[d], box.lower[d]);
      all.upper[d] = std::max(all.upper[d], box.upper[d]);
    }
  return all;
}

FieldHere field_here(const Simulation& simulation, Field field) {
  const FluidFields& cells = simulation.scene().flow->fields();
  FieldsSpec all;
  all.upper = simulation.setup().cells;
  all.quantities = {field};
  const Fields fields(simulation, all, Units{});
  const adapters::FieldQuantity quantity = fields.quantity(field);
  const std::size_t components = quantity.components;
  FieldHere here{box_of(cells), quantity.components, {}};
  here.values.assign(here.box.cells() * components, std::numeric_limits<double>::quiet_NaN());
  const Piece whole{0, int3(here.box.lower), int3(here.box.upper)};
  std::vector<double> plane;
  for (std::size_t k = 0; k < fields.pieces().size(); ++k) {
    const lbm::CellBox& block = cells.block(fields.pieces()[k].block);
    const std::size_t row = block.size.x * components;
    plane.resize(row * block.size.y);
    for (int z = 0; z < block.size.z; ++z) {
      quantity.values(k, z, z + 1, plane.data());
      for (int y = 0; y < block.size.y; ++y)
        std::copy_n(plane.data() + y * row, row,
                    here.values.data() + whole.index(block.lower + Int3{0, y, z}) * components);
    }
  }
  return here;
}

void write_flow_fields(const Simulation& simulation, const FieldsSpec& spec,
                       const std::filesystem::path& folder, const adapters::Provenance& provenance) {
  const Units& units = simulation.setup().units;
  const FluidFields& cells = simulation.scene().flow->fields();
  const Fields fields(simulation, spec, units);
  adapters::FieldSnapshot snapshot;
  for (int d = 0; d < 3; ++d) {
    snapshot.grid.cells[d] = spec.upper[d] - spec.lower[d];
    snapshot.grid.origin[d] = spec.lower[d] * units.cell_size;
    snapshot.grid.spacing[d] = units.cell_size;
  }
  if (units.si) {
    snapshot.grid.length_unit = std::string("m");
    snapshot.grid.time_unit = std::string("s");
  }
  for (const Field field : spec.quantities) snapshot.quantities.push_back(fields.quantity(field));
  snapshot.compression = spec.compression;
  snapshot.step = simulation.steps_done();
  snapshot.time = static_cast<double>(snapshot.step) * units.time_step;
  std::vector<adapters::CellBox> boxes;
  for (const Piece& piece : fields.pieces()) {
    adapters::CellBox box;
    for (int d = 0; d < 3; ++d) {
      const int corner = cells.block(piece.block).lower[d] - spec.lower[d];
      box.lower[d] = corner + piece.first[d], box.upper[d] = corner + piece.last[d];
    }
    boxes.push_back(box);
  }
  const auto path = adapters::step_path(folder, spec.name, snapshot.step, ".hdf");
  parallel::naming(path.string(), [&] {
    adapters::write_fields(simulation.scene().comm, path, boxes, snapshot, provenance);
  });
}

}  // namespace silt::coupler
