#pragma once
// The room of a [[fill]]: the box for centres of bounding spheres, the space that curved walls leave, and the
// sites of ordered arrangements.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coupler/spec/counter_random.hpp"
#include "rigid/bodies/body_exchange.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/triangle_mesh.hpp"
#include "rigid/shapes/tube.hpp"
#include "silt/case/case.hpp"

namespace silt {

/// One application of a fill for one size; `number` counts earlier applications.
struct FillApplication {
  std::size_t fill;
  std::uint64_t number;
  std::size_t size;

  FillApplication(std::size_t fill, std::uint64_t number = 0, std::size_t size = 0)
      : fill(fill), number(number), size(size) {}
  bool is_first() const { return number == 0; }
  /// Returns the key of its random numbers, which differ between applications for any seeds.
  std::uint64_t key(const FillSpec& spec) const {
    return coupler::mixed(spec.seed) ^ coupler::mixed(~(fill | size << 16 | number << 24));
  }
  /// Returns the number of bodies. Of `count` bodies of all sizes, body j has the size at the cumulative
  /// share (j + u) / count, with a random number u per application, so that numbers follow the distribution
  /// to within one body, also over many small applications. 0: all sites of an ordered arrangement.
  std::int64_t count(const FillSpec&) const;
};

/// The curved walls of a case at the start, as obstacles.
class CurvedWalls {
 public:
  explicit CurvedWalls(const Case&);

  /// Returns whether a ball touches no curved wall.
  bool are_clear_of(const rigid::Vec3& centre, double radius) const;
  /// Returns the share of a box that is free for centres of balls, sampled at 32 points per edge.
  double share_left(const rigid::BoundingBox& room, double radius) const;
  bool empty() const { return tubes_.empty() && meshes_.empty(); }

 private:
  std::vector<std::pair<rigid::Tube, rigid::Pose>> tubes_;
  std::vector<std::pair<rigid::Mesh, rigid::Pose>> meshes_;
};

/// Returns the box of a fill less the radius on each side, and less the gap at walls; all of [0, length]
/// along a periodic axis that the box covers. Throws CaseError if no body fits.
rigid::BoundingBox room_for_centres(const Case&, std::size_t fill, double radius);

/// Returns the mean volume of a fill's bodies.
double mean_volume(const Case&, const FillSpec&);

/// The sites of an arrangement: rows along x, side by side along y in layers, which are stacked along z.
/// Along a periodic axis that the room covers, sites are spread to fit; along others they are centred.
class Lattice {
 public:
  using Index = std::array<std::int64_t, 3>;
  /// `spacing` is the least distance of neighbours, `room` the box for sites.
  Lattice(const rigid::BoundingBox& room, const rigid::Extent&, Arrangement, double spacing);

  const Index& sites() const { return count_; }
  std::uint64_t total() const { return static_cast<std::uint64_t>(count_[0] * count_[1] * count_[2]); }
  std::uint64_t number(const Index& i) const {
    return static_cast<std::uint64_t>((i[2] * count_[1] + i[1]) * count_[0] + i[0]);
  }
  /// Returns the position of a site, not wrapped. Sites of shifted rows and layers may be outside the room.
  rigid::Vec3 site(const Index&) const;
  bool in_room(const rigid::Vec3& site) const;
  bool goes_round(int axis) const { return round_[axis]; }
  /// Return the step between sites along an axis, and the first site, up to the shift of rows and layers.
  double step(int axis) const { return step_[axis]; }
  double first(int axis) const { return first_[axis]; }

 private:
  bool closest_;  // close packing: alternate rows and layers are shifted
  rigid::BoundingBox room_;
  Index count_{};
  std::array<double, 3> first_{}, step_{};
  std::array<bool, 3> round_{};
};

/// Returns the sites for bodies of a bounding radius. Throws CaseError if they are too close.
Lattice lattice_of(const Case&, FillApplication, double radius);

}  // namespace silt
