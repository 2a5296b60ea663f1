#pragma once
// Fast Frictional Dynamics as in the paper (SC10 section III; Kaufman, Edmunds, Pai 2005): each body is
// solved once, by itself. A baseline for sffd with its known defects: momentum is not conserved with several
// contacts, friction is bounded by velocities, half the force is lost in contact (method.md, F1 to F4).
#include <Eigen/Dense>
#include <span>

#include "rigid/response/contact_resolver.hpp"

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

/// Finds the point of a polyhedron in R^6 closest to the origin by the dual active-set method (Goldfarb,
/// Idnani, "A numerically stable dual method for solving strictly convex quadratic programs", 1983) for a
/// unit matrix: min |y|^2 / 2 subject to all constraints. It starts at the origin, adds the most violated
/// constraint and drops those whose multiplier would become negative; at most six are active.
ClosestPoint closest_to_origin(std::span<const HalfSpace6> constraints);

class FfdResolver : public ContactResolver {
 public:
  explicit FfdResolver(const ResolverSettings& settings) : settings_(settings) {}
  std::string_view name() const override { return "ffd"; }
  double first_kick() const override { return 0.5; }
  ResolverStatistics resolve(BodySet&, const std::vector<Contact>&, double dt, StepVelocities&,
                             BodyExchange&) override;

 private:
  /// A constraint on one body of a contact: N . phi >= offset + correction, phi = (omega, v).
  struct Constraint {
    Vec3 normal, r;  // normal: into the body
    Vec6 covector;   // (r x n, n)
    double offset, correction, restitution, friction;
  };

  void add_constraints(const BodySet&, const Contact&, double dt);
  void respond(const BodySet&, std::size_t row, StepVelocities&, ResolverStatistics&) const;

  ResolverSettings settings_;
  std::vector<double> state_;                         // rows x 6: v, w
  std::vector<std::vector<Constraint>> constraints_;  // of each owned row, in key order
};

}  // namespace silt::rigid
