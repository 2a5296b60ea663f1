#pragma once
// Keeps the contact points of one pair of convex shapes few: one a feature, and no more than say something
// new.
#include <cstddef>
#include <vector>

#include "rigid/bodies/contact.hpp"

namespace silt::rigid {

inline constexpr std::size_t most_contact_points =
    8;  // of two convex shapes: a face of two boxes turned by 45 degrees

/// Appends a point; of two of the same feature the deeper stays.
void add_unique(std::vector<ContactPoint>& points, const ContactPoint& p);

/// Leaves at most most_contact_points: the deepest, and those furthest from each other. Keeps the order.
void reduce_manifold(std::vector<ContactPoint>& points);

}  // namespace silt::rigid
