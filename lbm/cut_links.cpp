#include "lbm/cut_links.hpp"

#include <limits>
#include <stdexcept>

#include "cpu/isa.hpp"
#include "lbm/cut_links_kernel.hpp"

namespace silt::lbm {

template <class T>
LinkSlots link_slots(const Block<T>& block, Parity parity) {
  const std::ptrdiff_t furthest =
      block.slot(directions - 1) + block.slot(1) - block.middle() + 2 * block.plane_stride();
  if (furthest > std::numeric_limits<std::int32_t>::max())
    throw std::invalid_argument("a block of more than 220 million cells; use smaller domain.blocks");
  const auto from_middle = [&](std::ptrdiff_t slot) { return std::int32_t(slot - block.middle()); };
  LinkSlots s;
  for (int i = 1; i < directions; ++i) {
    s.out[i] = from_middle(block.leaving(i, parity));
    s.back[i] = from_middle(block.arriving(opposite(i), parity));
    s.step[i] = std::int32_t(block.step(i));
  }
  return s;
}

namespace {

template <class T>
const LinkKernels<T>& link_kernels() {
  static const LinkKernels<T> kernels = SILT_CHOSEN(link_kernels<T>)();
  return kernels;
}

}  // namespace

template <class T>
void apply_cut_links(const GroupInBlock<T>& at, const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  link_kernels<T>().apply(at, motion, form, sums);
}

template <class T>
void correct_cut_links(const GroupInBlock<T>& at, const SurfaceMotion& increment, LinkSums& sums) {
  link_kernels<T>().correct(at, increment, sums);
}

template <class T>
StiffnessSums stiffness_of(const CutLinks<T>& links, int exponent) {
  StiffnessSums sums;
  SILT_CHOSEN(stiffness_kernel<T>)()(links, exponent, sums);
  return sums;
}

#define SILT_INSTANTIATE(T)                                                                           \
  template LinkSlots link_slots(const Block<T>&, Parity);                                             \
  template void apply_cut_links(const GroupInBlock<T>&, const SurfaceMotion&, ForceForm, LinkSums&);  \
  template void correct_cut_links(const GroupInBlock<T>&, const SurfaceMotion& increment, LinkSums&); \
  template StiffnessSums stiffness_of(const CutLinks<T>&, int);
SILT_INSTANTIATE(float)
SILT_INSTANTIATE(double)

}  // namespace silt::lbm
