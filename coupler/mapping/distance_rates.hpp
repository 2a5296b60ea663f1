#pragma once
// How wall distances change while a surface moves on from where it was mapped: in the steps until it is
// mapped again its links follow it, to first order.
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/surface_parts.hpp"
#include "lbm/cut_links.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::coupler {

/// Sets the rates of links, built in the middle of the body's steps, by their distances in the last of these;
/// of none if it is at rest or mapped for one step. `surface` is room for the body's parts. Crossing links
/// keep their distances: whether there is one at all depends on them.
template <class T>
void set_distance_rates(lbm::CutLinks<T>&, const rigid::Shape&, const MappedMotion&,
                        SurfaceParts<T>& surface);

}  // namespace silt::coupler
