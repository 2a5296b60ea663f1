#include "lbm/stream_collide.hpp"

#include "lbm/isa.hpp"
#include "lbm/kernels.hpp"

namespace silt::lbm {

template <class T>
void stream_collide(Block<T>& block, Parity parity, const CollisionRates<T>& rates, RowRange range) {
  SILT_DISPATCH(stream_collide_rows, block, parity, rates, range)
}
template void stream_collide(Block<float>&, Parity, const CollisionRates<float>&, RowRange);
template void stream_collide(Block<double>&, Parity, const CollisionRates<double>&, RowRange);

const char* instruction_set() {
  switch (chosen_isa()) {
    case Isa::avx512:
      return "avx512";
    case Isa::avx2:
      return "avx2";
    default:
      return "portable";
  }
}

}  // namespace silt::lbm
