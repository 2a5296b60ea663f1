#pragma once
// The work of a step in cells of several levels, and at the borders between them.
#include "lbm/domain.hpp"

namespace silt::coupler {

/// Returns the work of one finest step in a leaf of known level, where the update of a cell in its own step
/// is so much work: a cell of level l stands for 8^l finest ones and is updated in one of 2^l steps. To it
/// comes what crosses the leaf's faces to cells of the next level, the more the shorter the rows are that lie
/// in a face (method-fluid.md, "Levels").
std::int64_t work_of_leaf(const lbm::Domain& view, int leaf, std::int64_t work_of_a_cell);

}  // namespace silt::coupler
