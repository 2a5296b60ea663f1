#include "tests/bench/fluid_kernels.hpp"

#include "lbm/isa.hpp"

namespace silt::bench {

using lbm::chosen_isa, lbm::Isa;

template <class T>
void update_in_place(T* data, std::ptrdiff_t stride, std::ptrdiff_t cells, AccessShape shape) {
  SILT_DISPATCH(update_in_place, data, stride, cells, shape)
}
template <class T>
double add_and_multiply(T* result, int rounds) {
  SILT_DISPATCH(add_and_multiply, result, rounds)
}
template <class T>
void pull_and_relax(const TwoArrays<T>& arrays, Layout layout, Effort effort) {
  SILT_DISPATCH(pull_and_relax, arrays, layout, effort)
}

template void update_in_place(float*, std::ptrdiff_t, std::ptrdiff_t, AccessShape);
template void update_in_place(double*, std::ptrdiff_t, std::ptrdiff_t, AccessShape);
template double add_and_multiply(float*, int);
template double add_and_multiply(double*, int);
template void pull_and_relax(const TwoArrays<float>&, Layout, Effort);
template void pull_and_relax(const TwoArrays<double>&, Layout, Effort);

}  // namespace silt::bench
