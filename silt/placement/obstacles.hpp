#pragma once
// Obstacles may be in the way of a body that is to be placed: curved walls, given bodies, and bodies placed
// before it, here and near this rank.
#include <span>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "silt/case/fill_room.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/neighbour_grid.hpp"

namespace silt {

/// Returns how far a shape reaches into another, at least, in cells: positive only if they do overlap, so
/// that no legal scene is refused; exact for a sphere against anything; negative if no overlap is found
/// (then, for two spheres, minus their distance).
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b);

/// The largest over the periodic images of b.
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b, const rigid::Extent&);

/// Distance from a point to the nearest periodic image of a shape, negative inside.
double distance_to(const rigid::Shape&, const rigid::Pose&, const rigid::Vec3& x_W, const rigid::Extent&);

class Obstacles {
 public:
  /// The given bodies stay where they are; reach: the furthest anything is asked about.
  Obstacles(const Case&, const rigid::Extent&, std::span<const GivenBody>, double reach);

  /// Begins with balls of another radius, in an order of falling radii.
  void begin_balls(double radius, double gap);
  void add_ball(const rigid::Vec3& centre);
  /// Says whether a ball with a gap around it meets nothing.
  bool is_free(const rigid::Vec3& centre, double radius, double gap) const;

 private:
  struct Balls {
    double radius;
    NeighbourGrid grid;
    std::vector<rigid::Vec3> centres;
  };

  const Case& setup_;
  const rigid::Extent extent_;
  const std::span<const GivenBody> given_;
  const CurvedWalls walls_;
  NeighbourGrid given_grid_;
  std::vector<Balls> balls_;
};

}  // namespace silt
