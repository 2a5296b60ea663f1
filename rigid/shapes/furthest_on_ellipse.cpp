#include "rigid/shapes/furthest_on_ellipse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rigid/math/elementary.hpp"

namespace silt::rigid {

namespace {

using Vec2 = Eigen::Vector2d;

/// Where `slope`, above 0 before and below after it, crosses 0 in the angles between.
template <class Slope>
double crossing(double low, double high, Slope&& slope) {
  constexpr int halvings = 55;  // of at most a quarter of a turn: to rounding
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (slope(middle) > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

FurthestOnEllipse furthest_on_ellipse(const Vec2& centre, const Eigen::Matrix2d& spread) {
  const double mean = 0.5 * (spread(0, 0) + spread(1, 1)), half = 0.5 * (spread(0, 0) - spread(1, 1));
  const double k = 2 * elementary::hypot(half, spread(0, 1));  // a^2 - b^2
  const double turn = 0.5 * elementary::atan2(spread(0, 1), half);
  Vec2 along(elementary::cos(turn), elementary::sin(turn)), across(-along[1], along[0]);
  const int near_end = along.dot(centre) < 0;
  if (near_end) along = -along;
  if (across.dot(centre) < 0) across = -across;
  const double p = along.dot(centre), q = across.dot(centre);
  const double a = std::sqrt(mean + 0.5 * k), b = std::sqrt(std::max(0.0, mean - 0.5 * k));
  const double pa = p * a, qb = q * b;
  const auto direction = [&](double t) -> Vec2 {
    const Vec2 x = (p + a * elementary::cos(t)) * along + (q + b * elementary::sin(t)) * across;
    const double length = x.norm();
    return length > 0 ? Vec2(x / length) : along;
  };

  constexpr double quarter = 0.5 * std::numbers::pi;
  FurthestOnEllipse found;
  found.end = {near_end, 1 - near_end};
  found.direction[0] = direction(crossing(0, quarter, [&](double t) {
    const double s = elementary::sin(t), c = elementary::cos(t);
    return qb * c - pa * s - k * s * c;
  }));
  const double least = elementary::atan2(elementary::cbrt(qb), elementary::cbrt(pa));
  const double sum = elementary::cbrt(pa * pa) + elementary::cbrt(qb * qb);
  if (sum * std::sqrt(sum) < k) {
    const double t = std::numbers::pi - crossing(0, least, [&](double s) {
                       return pa * elementary::sin(s) + qb * elementary::cos(s) -
                              k * elementary::sin(s) * elementary::cos(s);
                     });
    found.direction[1] = direction(t);
    found.count = 2;
  }
  return found;
}

}  // namespace silt::rigid
