#pragma once
// The flat round end of a shape of revolution: what of it meets another body.
#include <cmath>

#include "rigid/math/elementary.hpp"
#include "rigid/shapes/solid.hpp"

namespace silt::rigid {

/// It lies across the third axis; its outward normal is that axis or, on side -1, its opposite.
struct Disc {
  double radius, z;
  int side;  // -1 or 1

  /// Points of the rim that stand for the disc, at fixed angles of its frame.
  static constexpr int rim_points = 8;
  /// Sine of the tilt up to which it lies flat against a plane. Beyond, only the furthest point of its rim
  /// can meet the plane: of points fixed on the rim, those beside it would roll into the plane and be stopped
  /// while they are still above it.
  static constexpr double flat_sine = 0.1;

  // Codes of a shape of revolution: 0 unused, then the rim points of either end, the chords between them, the
  // ends, the side, and the points where an end's rim is furthest along the normal.
  static constexpr std::uint32_t first_rim = 1, first_chord = first_rim + 2 * rim_points,
                                 first_end = first_chord + 2 * rim_points, side_code = first_end + 2,
                                 first_lowest = side_code + 1;

  bool is_flat_against(const Vec3& n_B) const {
    return (n_B.z() < 0) == (side < 0) && elementary::hypot(n_B.x(), n_B.y()) <= flat_sine;
  }
  /// The point of the rim that is furthest along n.
  ContactOutline::Corner lowest(const Placement&, const Vec3& n) const;
  void outline(const Placement&, ContactOutline& out) const;
  /// Adds, of a disc that lies flat against a plane normal to n, the rim points, and the lowest point of the
  /// rim, of one that does not the lowest point alone.
  void add_plane_points(const Placement&, const Vec3& n, std::vector<PlanePoint>& out) const;
};

/// Derivative by the unit direction n of a circle's supporting point, the circle of this radius about z.
Mat3 rim_derivative(double radius, const Vec3& n);

}  // namespace silt::rigid
