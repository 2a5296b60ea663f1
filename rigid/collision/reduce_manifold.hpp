#pragma once
// Thins out the contact points of one pair of convex shapes: more than a few only repeat each other.
#include <cstddef>
#include <vector>

#include "rigid/bodies/contact.hpp"

namespace silt::rigid {

inline constexpr std::size_t most_contact_points =
    8;  // of two convex shapes: a face of two boxes turned by 45 degrees

/// Leaves at most most_contact_points: the deepest, and those furthest from each other. Keeps the order.
void reduce_manifold(std::vector<ContactPoint>& points);

}  // namespace silt::rigid
