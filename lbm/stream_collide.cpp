#include "lbm/stream_collide.hpp"

#include "cpu/isa.hpp"
#include "lbm/stream_collide_kernel.hpp"

namespace silt::lbm {

template <class T>
void stream_collide(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                    const WatchedPlanes& watched) {
  const auto kernel_of = SILT_CHOSEN(collide_rows<T>);
  kernel_of(rates)(block, parity, rates, range, watched);
}
template void stream_collide(Block<float>&, Parity, const CollisionRates<float>&, RowRange,
                             const WatchedPlanes&);
template void stream_collide(Block<double>&, Parity, const CollisionRates<double>&, RowRange,
                             const WatchedPlanes&);

}  // namespace silt::lbm
