#include "coupler/forces/spring_set.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace silt::coupler {
namespace {

using rigid::Mat3;
using rigid::Vec3;
using Vector = Eigen::VectorXd;
using Matrix = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

constexpr int freedoms = 6;  // degrees of freedom of a body

void put(Entries& entries, Eigen::Index row, Eigen::Index column, const Mat3& block) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) entries.emplace_back(row + i, column + j, block(i, j));
}

Matrix matrix_of(const Entries& entries, Eigen::Index rows, Eigen::Index columns) {
  Matrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Returns the matrix from the bodies' motions to the relative motions of the springs' ends. Motions are
/// scaled to unit mass and inertia, so the transpose maps forces to motions.
Matrix parting(std::span<const SpringInStep> springs, std::span<const Yield> bodies) {
  Entries entries;
  for (std::size_t k = 0; k < springs.size(); ++k)
    for (int end = 0; end < 2; ++end) {
      const int body = springs[k].bodies[end];
      if (body < 0) continue;
      const Yield& yield = bodies[std::size_t(body)];
      const double sign = end == 0 ? -1 : 1;
      Mat3 turned;
      for (int d = 0; d < 3; ++d) turned.col(d) = sign * yield.about.col(d).cross(springs[k].arms[end]);
      put(entries, Eigen::Index(3 * k), freedoms * body, Mat3((sign * yield.along).asDiagonal()));
      put(entries, Eigen::Index(3 * k), freedoms * body + 3, turned);
    }
  return matrix_of(entries, Eigen::Index(3 * springs.size()), Eigen::Index(freedoms * bodies.size()));
}

/// Returns the block-diagonal matrix of the dampers.
Matrix dampers(std::span<const SpringInStep> springs) {
  Entries entries;
  for (std::size_t k = 0; k < springs.size(); ++k)
    put(entries, Eigen::Index(3 * k), Eigen::Index(3 * k), springs[k].damping);
  return matrix_of(entries, Eigen::Index(3 * springs.size()), Eigen::Index(3 * springs.size()));
}

Vector stacked(std::span<const SpringInStep> springs, Vec3 SpringInStep::*of) {
  Vector all(Eigen::Index(3 * springs.size()));
  for (std::size_t k = 0; k < springs.size(); ++k) all.segment<3>(Eigen::Index(3 * k)) = springs[k].*of;
  return all;
}

}  // namespace

std::vector<Vec3> forces_of(std::span<const SpringInStep> springs, std::span<const Yield> bodies) {
  Vector force = stacked(springs, &SpringInStep::force);
  const auto is_damped = [](const SpringInStep& spring) { return !spring.damping.isZero(0); };
  if (std::ranges::any_of(springs, is_damped)) {
    const Matrix parts = parting(springs, bodies), moves = parts.transpose(), damping = dampers(springs);
    const double beta = (3 + std::sqrt(3.0)) / 6;
    const double weights[][2] = {{beta, beta}, {beta, 1.0 / 6}, {1 - 2 * beta, 1.0 / 3 - beta}};  // (50b)
    Matrix one(moves.rows(), moves.rows());
    one.setIdentity();
    const Eigen::SimplicialLDLT<Matrix> damped(Matrix(one + beta * (moves * damping * parts)));
    Vector rate = stacked(springs, &SpringInStep::rate),
           gain = stacked(springs, &SpringInStep::gain) - parts * (moves * force);
    for (const auto& [of_rate, of_gain] : weights) {
      rate -= beta * (parts * damped.solve(moves * (damping * rate)));
      gain -= beta * (parts * damped.solve(moves * (damping * gain)));
      force += damping * (of_rate * rate + of_gain * gain);
    }
  }
  std::vector<Vec3> forces;
  for (std::size_t k = 0; k < springs.size(); ++k) forces.emplace_back(force.segment<3>(Eigen::Index(3 * k)));
  return forces;
}

}  // namespace silt::coupler
