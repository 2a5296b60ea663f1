#include "lbm/cut_links.hpp"

#include "lbm/isa.hpp"
#include "lbm/kernels.hpp"

namespace silt::lbm {

namespace {
template <class T>
void apply_one(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkRun& run,
               const SurfaceMotion& motion, ForceForm form, LinkSums& sums) {
  SILT_DISPATCH(apply_run, block, parity, links, run, motion, form, sums)
}
template <class T>
void correct_one(Block<T>& block, Parity parity, const CutLinks<T>& links, const LinkRun& run,
                 const SurfaceMotion& increment, LinkSums& sums) {
  SILT_DISPATCH(correct_run, block, parity, links, run, increment, sums)
}
template <class T>
void stiffness_one(const CutLinks<T>& links, const LinkRun& run, StiffnessSums& sums) {
  SILT_DISPATCH(stiffness_run, links, run, sums)
}
}  // namespace

template <class T>
void apply_cut_links(Block<T>& block, Parity parity, const CutLinks<T>& links, const SurfaceMotion* motions,
                     ForceForm form, LinkSums* sums) {
  for (const auto& run : links.runs)
    apply_one(block, parity, links, run, motions[run.surface], form, sums[run.surface]);
}

template <class T>
void correct_cut_links(Block<T>& block, Parity parity, const CutLinks<T>& links,
                       const SurfaceMotion* increments, LinkSums* sums) {
  for (const auto& run : links.runs)
    correct_one(block, parity, links, run, increments[run.surface], sums[run.surface]);
}

template <class T>
void sum_stiffness(const CutLinks<T>& links, StiffnessSums* sums) {
  for (const auto& run : links.runs) stiffness_one(links, run, sums[run.surface]);
}

#define SILT_INSTANTIATE(T)                                                                                \
  template void apply_cut_links(Block<T>&, Parity, const CutLinks<T>&, const SurfaceMotion*, ForceForm,    \
                                LinkSums*);                                                                \
  template void correct_cut_links(Block<T>&, Parity, const CutLinks<T>&, const SurfaceMotion*, LinkSums*); \
  template void sum_stiffness(const CutLinks<T>&, StiffnessSums*);
SILT_INSTANTIATE(float)
SILT_INSTANTIATE(double)

}  // namespace silt::lbm
