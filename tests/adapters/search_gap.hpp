#pragma once
// The gap of any two convex shapes by trying directions: a method that shares nothing with adapters/.
#include "tests/adapters/pair_scenes.hpp"

namespace silt::tests {

/// The largest of s(n) = n . (support_B(-n) - support_A(n)), by rigid::support, which has its maximum either
/// where two edges or a face fix n (all of them are tried), or on the great circle normal to an edge (each is
/// sampled, the best places refined by golden sections), or where s is smooth (a grid of directions, the best
/// of them refined by the method of Nelder and Mead).
ReferenceGap search_gap(const Pair&);

}  // namespace silt::tests
