#pragma once
// The flat round end of a shape of revolution, and the points and outlines with which it meets other bodies.
#include <cmath>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// A disc across the z axis with the outward normal side * z.
struct Disc {
  double radius, z;
  int side;  // -1 or 1

  /// Number of rim points that represent the disc, at fixed angles of its frame.
  static constexpr int rim_points = 8;
  /// Sine of the largest tilt at which the disc counts as flat against a plane. Beyond it only the furthest
  /// rim point can touch: fixed points beside it would be stopped above the plane.
  static constexpr double flat_sine = 0.1;

  // Feature codes of a shape of revolution: 0 is unused; then the rim points of both ends, the chords between
  // them, the ends, the side, and for each end the rim point furthest along the normal.
  static constexpr std::uint32_t first_rim = 1, first_chord = first_rim + 2 * rim_points,
                                 first_end = first_chord + 2 * rim_points, side_code = first_end + 2,
                                 first_lowest = side_code + 1;

  bool is_flat_against(const Vec3& n_B) const {
    return (n_B.z() < 0) == (side < 0) && elementary::hypot(n_B.x(), n_B.y()) <= flat_sine;
  }
  /// Returns the rim point furthest along n.
  ContactOutline::Corner lowest(const Placement&, const Vec3& n) const;
  void outline(const Placement&, ContactOutline& out) const;
  /// Adds the candidates for contact with a plane normal to n: the lowest rim point, and if the disc is flat
  /// against the plane the fixed rim points as well.
  void add_plane_points(const Placement&, const Vec3& n, std::vector<PlanePoint>& out) const;
};

/// Returns the derivative, by the unit direction n, of the support point of a circle of this radius about z.
Mat3 rim_derivative(double radius, const Vec3& n);

}  // namespace silt::rigid
