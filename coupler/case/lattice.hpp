#pragma once
// The sites of a fill that is not random: regular places in the room for its bodies' centres.
#include <array>
#include <cstddef>
#include <cstdint>

#include "coupler/case/body_spec.hpp"
#include "coupler/case/fill_application.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/shapes/bounding_box.hpp"

namespace silt::coupler {

struct Case;

/// Rows along x, rows side by side along y in layers, layers one above the other along z. Along a periodic
/// axis that the room covers, sites are moved apart until they meet its end; along others they stand in the
/// middle.
class Lattice {
 public:
  using Index = std::array<std::int64_t, 3>;
  /// spacing: distance of neighbours, at least. room: for sites.
  Lattice(const rigid::BoundingBox& room, const rigid::Extent&, Arrangement, double spacing,
          std::uint64_t stream);

  const Index& sites() const { return count_; }
  std::uint64_t total() const { return static_cast<std::uint64_t>(count_[0] * count_[1] * count_[2]); }
  std::uint64_t number(const Index& i) const {
    return static_cast<std::uint64_t>((i[2] * count_[1] + i[1]) * count_[0] + i[0]);
  }
  /// Where a site is, unwrapped. Those of layers or rows that are shifted may lie outside the room.
  rigid::Vec3 site(const Index&) const;
  bool in_room(const rigid::Vec3& site) const;
  bool goes_round(int axis) const { return round_[axis]; }
  /// The step from site to site of an axis, and where the first is, give or take a step.
  double step(int axis) const { return step_[axis]; }
  double first(int axis) const { return first_[axis]; }

 private:
  std::array<double, 2> layer_offset(std::int64_t layer) const;

  Arrangement arrangement_;
  rigid::BoundingBox room_;
  std::uint64_t stream_;
  Index count_{};
  std::array<double, 3> first_{}, step_{};
  std::array<bool, 3> round_{};
};

/// The sites of a fill with bodies of a bounding radius. CaseError if they are too close for them.
Lattice lattice_of(const Case&, FillApplication, double radius);

}  // namespace silt::coupler
