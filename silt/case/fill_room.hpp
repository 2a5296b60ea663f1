#pragma once
// The room for the bodies of a [[fill]]: that for the centres of their bounding spheres, what curved walls
// take of it, and the sites of bodies that are not placed at random.
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

/// An application names the size and the fill, and says how often they have been applied before.
struct FillApplication {
  std::size_t fill;
  std::uint64_t number;
  std::size_t size;

  FillApplication(std::size_t fill, std::uint64_t number = 0, std::size_t size = 0)
      : fill(fill), number(number), size(size) {}
  bool is_first() const { return number == 0; }
  /// Returns the key of its random numbers: none of them is one of another application, whatever the seeds.
  std::uint64_t key(const FillSpec& spec) const {
    return coupler::mixed(spec.seed) ^ coupler::mixed(~(fill | size << 16 | number << 24));
  }
  /// Returns how many bodies it has: of count bodies the j-th has the size up to which a share of
  /// (j + u) / count of all go, u being a random number of the fill's application. So numbers follow the
  /// distribution to a body, and those of many small applications do so together. 0 of a fill of sites: as
  /// many as there is room for.
  std::int64_t count(const FillSpec&) const;
};

/// The curved walls of a case at the start, as what is to be placed meets them.
class CurvedWalls {
 public:
  explicit CurvedWalls(const Case&);

  /// Says whether a ball of a radius about a point meets none of them.
  bool are_clear_of(const rigid::Vec3& centre, double radius) const;
  /// Returns the share of a box in which a ball's centre may be, by a look at 32 points along each edge.
  double share_left(const rigid::BoundingBox& room, double radius) const;
  bool empty() const { return tubes_.empty() && meshes_.empty(); }

 private:
  std::vector<std::pair<rigid::Tube, rigid::Pose>> tubes_;
  std::vector<std::pair<rigid::Mesh, rigid::Pose>> meshes_;
};

/// Returns the box of a fill less a radius, and less the gap too where a side of the box is a wall; all of
/// [0, length] along a periodic axis that the box covers. CaseError if not one body fits.
rigid::BoundingBox room_for_centres(const Case&, std::size_t fill, double radius);

/// The mean of the volumes of a fill's bodies.
double mean_volume(const Case&, const FillSpec&);

/// Rows along x, rows side by side along y in layers, layers one above the other along z. Along a periodic
/// axis that the room covers, sites are moved apart until they meet its end; along others they stand in the
/// middle.
class Lattice {
 public:
  using Index = std::array<std::int64_t, 3>;
  /// spacing: distance of neighbours, at least. room: for sites.
  Lattice(const rigid::BoundingBox& room, const rigid::Extent&, Arrangement, double spacing);

  const Index& sites() const { return count_; }
  std::uint64_t total() const { return static_cast<std::uint64_t>(count_[0] * count_[1] * count_[2]); }
  std::uint64_t number(const Index& i) const {
    return static_cast<std::uint64_t>((i[2] * count_[1] + i[1]) * count_[0] + i[0]);
  }
  /// Returns the place of a site, unwrapped. Those of rows and layers that are shifted may lie outside the
  /// room.
  rigid::Vec3 site(const Index&) const;
  bool in_room(const rigid::Vec3& site) const;
  bool goes_round(int axis) const { return round_[axis]; }
  /// The step from site to site of an axis, and where the first is, give or take a step.
  double step(int axis) const { return step_[axis]; }
  double first(int axis) const { return first_[axis]; }

 private:
  bool closest_;  // packing: every other row and layer is shifted
  rigid::BoundingBox room_;
  Index count_{};
  std::array<double, 3> first_{}, step_{};
  std::array<bool, 3> round_{};
};

/// The sites of a fill with bodies of a bounding radius. CaseError if they are too close for them.
Lattice lattice_of(const Case&, FillApplication, double radius);

}  // namespace silt
