#include "lbm/cut_links.hpp"

#include "lbm/isa.hpp"
#include "lbm/kernels.hpp"

namespace silt::lbm {

template <class T>
void apply_cut_links(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkGroup& group,
                     const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  SILT_DISPATCH(apply_group, block, parity, links, group, motion, form, sums)
}

template <class T>
void correct_cut_links(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkGroup& group,
                       const SurfaceMotion& increment, LinkSums& sums) {
  SILT_DISPATCH(correct_group, block, parity, links, group, increment, sums)
}

template <class T>
void sum_stiffness(const CutLinks<T>& links, const LinkGroup& group,
                   StiffnessSums& sums){SILT_DISPATCH(group_stiffness, links, group, sums)}

#define SILT_INSTANTIATE(T)                                                                \
  template void apply_cut_links(Block<T>&, Parity, const CutLinks<T>&, const LinkGroup&,   \
                                const SurfaceMotion&, ForceForm, LinkSums&);               \
  template void correct_cut_links(Block<T>&, Parity, const CutLinks<T>&, const LinkGroup&, \
                                  const SurfaceMotion&, LinkSums&);                        \
  template void sum_stiffness(const CutLinks<T>&, const LinkGroup&, StiffnessSums&);
SILT_INSTANTIATE(float) SILT_INSTANTIATE(double)

}  // namespace silt::lbm
