#pragma once
// The point of a polyhedron in R^6 closest to the origin: the dual active-set method of Goldfarb and Idnani
// (1983), "A numerically stable dual method for solving strictly convex quadratic programs", for a unit
// matrix.
#include <Eigen/Dense>
#include <span>

namespace silt::rigid {

using Vec6 = Eigen::Matrix<double, 6, 1>;

struct HalfSpace6 {
  Vec6 normal;
  double offset;  // normal . y >= offset
};

struct ClosestPoint {
  bool feasible;
  Vec6 y;
};

/// min |y|^2 / 2 subject to every constraint. Starts at the origin, adds the most violated constraint one at
/// a time and drops those whose multiplier would turn negative; at most six are active.
ClosestPoint closest_to_origin(std::span<const HalfSpace6> constraints);

}  // namespace silt::rigid
