#pragma once
// From the map of a block to its cut links: for every fluid cell next to a body's cell, how far the surface
// is.
#include "coupler/case.hpp"
#include "coupler/solid_map.hpp"
#include "lbm/cut_links.hpp"
#include "rigid/body_set.hpp"
#include "rigid/world.hpp"

namespace silt::coupler {

/// Rebuilds all links of the block; run.surface is the index of the body's mask. `cli`: with wall distances,
/// 1/2 where the cell behind is not fluid (a narrow gap) or, for the bounce-back scheme, everywhere.
template <class T>
void build_links(const BlockMap&, const lbm::Block<T>&, const rigid::World&, const rigid::BodySet&,
                 WallScheme, lbm::CutLinks<T>&);

}  // namespace silt::coupler
