#include "rigid/collision/reduce_manifold.hpp"

#include <algorithm>
#include <limits>

namespace silt::rigid {

void add_unique(std::vector<ContactPoint>& points, const ContactPoint& p) {
  for (ContactPoint& q : points)
    if (q.feature == p.feature) {
      if (p.gap < q.gap) q = p;
      return;
    }
  points.push_back(p);
}

void reduce_manifold(std::vector<ContactPoint>& points) {
  if (points.size() <= most_contact_points) return;
  std::vector<double> apart(points.size(),
                            std::numeric_limits<double>::infinity());  // squared, from those kept
  std::vector<char> kept(points.size(), 0);
  std::size_t next = std::min_element(points.begin(), points.end(),
                                      [](const auto& p, const auto& q) { return p.gap < q.gap; }) -
                     points.begin();
  for (std::size_t count = 0; count < most_contact_points; ++count) {
    kept[next] = 1;
    for (std::size_t k = 0; k < points.size(); ++k)
      apart[k] = std::min(apart[k], (points[k].on_a - points[next].on_a).squaredNorm());
    next = std::max_element(apart.begin(), apart.end()) - apart.begin();
  }
  std::size_t k = 0;
  std::erase_if(points, [&](const ContactPoint&) { return !kept[k++]; });
}

}  // namespace silt::rigid
