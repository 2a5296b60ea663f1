#pragma once
// The dense kernel as each of its builds offers it (stream_collide_kernel.cpp).
#include "cpu/isa.hpp"
#include "lbm/collision.hpp"
#include "lbm/stream_collide.hpp"

namespace silt::lbm {

template <class T>
using CollideRows = void (*)(Block<T>&, Parity, const CollisionRates<T>&, RowRange, const WatchedPlanes&);

/// The kernel of a collision.
SILT_BUILDS(template <class T> CollideRows<T> collide_rows(const CollisionRates<T>&);)

}  // namespace silt::lbm
