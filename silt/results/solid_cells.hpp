#pragma once
// Finds the cells that bodies cover, for writing fields.
#include <algorithm>
#include <cmath>
#include <vector>

#include "coupler/exchange/coupling_state.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// The cells [first, last) of a block that are written, in block coordinates.
struct Piece {
  int block;
  lbm::Int3 first, last;

  /// Calls visit(cell, i) for each cell, x fastest.
  template <class Visit>
  void for_each(Visit&& visit) const {
    std::size_t i = 0;
    coupler::for_cells(first, last, [&](lbm::Int3 cell) { visit(cell, i++); });
  }
  /// Returns planes [begin, end), counted from its first.
  Piece planes(int begin, int end) const {
    Piece part = *this;
    part.first.z = first.z + begin, part.last.z = first.z + end;
    return part;
  }
  std::size_t index(lbm::Int3 cell) const {
    const lbm::Int3 n = last - first, x = cell - first;
    return (std::size_t(x.z) * n.y + x.y) * n.x + x.x;
  }
};

/// The bodies at their last mapping poses; they lie in finest cells.
class SolidCells {
 public:
  SolidCells(const Simulation& simulation, const coupler::FluidFields& fields)
      : fields_(fields),
        bodies_(simulation.bodies()),
        world_(simulation.scene().world),
        extent_(simulation.scene().exchange->extent()) {
    for (std::size_t row = 0; fields.level() == 0 && row < bodies_.first_wall(); ++row)
      reach_.push_back(
          rigid::bounding_box(world_.shapes[bodies_.shape[row]], coupler::mapping_pose(bodies_, row)));
  }

  /// Calls visit(row, cell, r) for solid cells of a piece in bodies, at r from the centre of the body.
  template <class Visit>
  void for_each(const Piece& piece, Visit&& visit) const {
    for (std::size_t row = 0; row < reach_.size(); ++row)
      for_images(piece, row, 2, rigid::Vec3::Zero(), visit);
  }

 private:
  /// Restricts the piece to images of a body, axis by axis down from this one: few planes overlap along z.
  template <class Visit>
  void for_images(const Piece& piece, std::size_t row, int axis, rigid::Vec3 shift, Visit&& visit) const {
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
  void for_image(const Piece& piece, std::size_t row, const rigid::Vec3& shift, Visit&& visit) const {
    const lbm::Int3 corner = fields_.block(piece.block).lower;
    rigid::Pose pose = coupler::mapping_pose(bodies_, row);
    pose.position += shift;
    const rigid::Shape& shape = world_.shapes[bodies_.shape[row]];
    piece.for_each([&](lbm::Int3 cell, std::size_t) {
      const lbm::Int3 global = corner + cell;
      const rigid::Vec3 centre(global.x + 0.5, global.y + 0.5, global.z + 0.5);
      if (!fields_.is_fluid(piece.block, cell) && rigid::contains(shape, pose.to_body(centre)))
        visit(row, cell, rigid::Vec3(centre - pose.position));
    });
  }

  const coupler::FluidFields& fields_;
  const rigid::BodySet& bodies_;
  const rigid::World& world_;
  const rigid::Extent& extent_;
  std::vector<rigid::BoundingBox> reach_;  // per row
};

}  // namespace silt
