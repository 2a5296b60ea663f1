#pragma once
// The obstacles of bodies to be placed: curved walls, given bodies, and bodies placed before.
#include <span>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "silt/case/fill_room.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/neighbour_grid.hpp"

namespace silt {

/// Returns a lower bound of the overlap of two shapes in cells. Positive only if they overlap, so that no
/// valid scene is rejected; exact if one is a sphere; negative if none is found (two spheres: -distance).
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b);

/// Returns the largest overlap over the periodic images of b.
double overlap_depth(const rigid::Shape& a, const rigid::Pose& pose_a, const rigid::Shape& b,
                     const rigid::Pose& pose_b, const rigid::Extent&);

/// Returns the distance from a point to the nearest periodic image of a shape, negative inside.
double distance_to(const rigid::Shape&, const rigid::Pose&, const rigid::Vec3& x_W, const rigid::Extent&);

class Obstacles {
 public:
  /// Refers to the given bodies; `reach` is the largest distance of any query.
  Obstacles(const Case&, const rigid::Extent&, std::span<const GivenBody>, double reach);

  /// Begins balls of another radius; radii must decrease.
  void begin_balls(double radius, double gap);
  void add_ball(const rigid::Vec3& centre);
  /// Returns whether a ball with a gap around it touches no obstacle.
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
