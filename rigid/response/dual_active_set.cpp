#include "rigid/response/dual_active_set.hpp"

#include <limits>
#include <vector>

namespace silt::rigid {

namespace {

constexpr double violation = 1e-12;     // relative to the constraint's size: taken as satisfied
constexpr double dependent = 1e-10;     // part of a unit normal outside the span of the active ones: none
constexpr int steps_a_constraint = 20;  // bound on the steps, against cycling by rounding

class ActiveSet {
 public:
  explicit ActiveSet(std::span<const HalfSpace6> all) : all_(all) {}
  Vec6 y = Vec6::Zero();

  /// Moves until constraint p holds. False: it contradicts the active ones.
  bool enforce(std::size_t p) {
    double multiplier = 0;
    for (int i = 0; i < steps_a_constraint; ++i) {
      const Vec6& n = all_[p].normal;
      const Eigen::VectorXd r = in_terms_of_active(n);
      Vec6 z = n;
      for (std::size_t k = 0; k < active_.size(); ++k) z -= r[k] * all_[active_[k]].normal;
      const double infinity = std::numeric_limits<double>::infinity();
      double dual_step = infinity;
      std::size_t leaving = 0;
      for (std::size_t k = 0; k < active_.size(); ++k)
        if (r[k] > 0 && multipliers_[k] / r[k] < dual_step) dual_step = multipliers_[k] / r[k], leaving = k;
      const bool movable = active_.size() < 6 && z.norm() > dependent * n.norm();
      const double primal_step = movable ? (all_[p].offset - n.dot(y)) / z.dot(n) : infinity;
      const double step = std::min(dual_step, primal_step);
      if (step == infinity) return false;
      if (movable) y += step * z;
      for (std::size_t k = 0; k < active_.size(); ++k) multipliers_[k] -= step * r[k];
      multiplier += step;
      if (primal_step <= dual_step) {
        active_.push_back(p);
        multipliers_.push_back(multiplier);
        return true;
      }
      active_.erase(active_.begin() + leaving);
      multipliers_.erase(multipliers_.begin() + leaving);
    }
    return false;
  }

 private:
  Eigen::VectorXd in_terms_of_active(const Vec6& n) const {
    if (active_.empty()) return {};
    Eigen::Matrix<double, 6, Eigen::Dynamic> normals(6, active_.size());
    for (std::size_t k = 0; k < active_.size(); ++k) normals.col(k) = all_[active_[k]].normal;
    return normals.colPivHouseholderQr().solve(n);
  }

  std::span<const HalfSpace6> all_;
  std::vector<std::size_t> active_;
  std::vector<double> multipliers_;
};

}  // namespace

ClosestPoint closest_to_origin(std::span<const HalfSpace6> constraints) {
  ActiveSet set(constraints);
  for (std::size_t i = 0; i < steps_a_constraint * (constraints.size() + 1); ++i) {
    std::size_t worst = constraints.size();
    double most = 0;
    for (std::size_t k = 0; k < constraints.size(); ++k) {
      const HalfSpace6& c = constraints[k];
      const double size = c.normal.norm();
      const double missing = (c.offset - c.normal.dot(set.y)) / size;
      if (missing > most && missing > violation * (set.y.norm() + std::abs(c.offset) / size)) {
        most = missing;
        worst = k;
      }
    }
    if (worst == constraints.size()) return {true, set.y};
    if (!set.enforce(worst)) return {false, set.y};
  }
  return {false, set.y};
}

}  // namespace silt::rigid
