#include "lbm/cut_links.hpp"

#include <limits>
#include <stdexcept>

#include "lbm/isa.hpp"
#include "lbm/kernels.hpp"

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
    const int j = opposite(i);
    s.out[i] = from_middle(block.leaving(i, parity)), s.behind[i] = from_middle(block.arriving(i, parity));
    s.against[i] = from_middle(block.leaving(j, parity)), s.back[i] = from_middle(block.arriving(j, parity));
  }
  return s;
}

template <class T>
void apply_cut_links(Block<T>& block, const LinkSlots& slots, const CutLinks<T>& links,
                     const LinkGroup& group, const SurfaceMotion& motion, ForceForm form, LinkSums& sums,
                     const NextGroup<T>& next) {
  SILT_DISPATCH(apply_group, block, slots, links, group, motion, form, sums, next)
}

template <class T>
void correct_cut_links(Block<T>& block, const LinkSlots& slots, const CutLinks<T>& links,
                       const LinkGroup& group, const SurfaceMotion& increment, LinkSums& sums,
                       const NextGroup<T>& next) {
  SILT_DISPATCH(correct_group, block, slots, links, group, increment, sums, next)
}

namespace {
template <class T>
void add_stiffness(const CutLinks<T>& links, int exponent, StiffnessSums& sums) {
  SILT_DISPATCH(surface_stiffness, links, exponent, sums)
}
}  // namespace

template <class T>
StiffnessSums stiffness_of(const CutLinks<T>& links, int exponent) {
  StiffnessSums sums;
  add_stiffness(links, exponent, sums);
  return sums;
}

#define SILT_INSTANTIATE(T)                                                                          \
  template LinkSlots link_slots(const Block<T>&, Parity);                                            \
  template void apply_cut_links(Block<T>&, const LinkSlots&, const CutLinks<T>&, const LinkGroup&,   \
                                const SurfaceMotion&, ForceForm, LinkSums&, const NextGroup<T>&);    \
  template void correct_cut_links(Block<T>&, const LinkSlots&, const CutLinks<T>&, const LinkGroup&, \
                                  const SurfaceMotion&, LinkSums&, const NextGroup<T>&);             \
  template StiffnessSums stiffness_of(const CutLinks<T>&, int);
SILT_INSTANTIATE(float) SILT_INSTANTIATE(double)

}  // namespace silt::lbm
