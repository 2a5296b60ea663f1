#include "lbm/stream_collide.hpp"

#include "cpu/isa.hpp"
#include "lbm/stream_collide_kernel.hpp"

namespace silt::lbm {

template <class T>
double stream_collide(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range,
                      const WatchedPlanes& watched) {
  const auto kernel_of = chosen(portable::collide_rows<T>, avx2::collide_rows<T>, avx512::collide_rows<T>);
  return kernel_of(rates)(block, parity, rates, range, watched);
}
template double stream_collide(Block<float>&, Parity, const CollisionRates<float>&, RowRange,
                               const WatchedPlanes&);
template double stream_collide(Block<double>&, Parity, const CollisionRates<double>&, RowRange,
                               const WatchedPlanes&);

}  // namespace silt::lbm
