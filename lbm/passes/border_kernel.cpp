// The passes over a border between levels, built once per instruction set (SILT_BUILD).
#include "lbm/passes/border_kernel.hpp"

#include "lbm/passes/cross_border.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

template <class Step, class T, class Entries>
void over_patches(const Step& step, const BorderPatches<T>& border, const Entries& entries) {
  for (const auto& entry : entries) step(border, entry, PatchPart::all_of(entry.size));
}

template <class T>
void cross_border(const BorderPatches<T>& given, const BorderLists<T>& lists,
                  std::span<const typename BorderPatches<T>::Passing> passing) {
  BorderPatches<T> border = given;
  border.refer_to(lists);
  in_steps<T>(lists, passing,
              [&](const auto& step, const auto& entries) { over_patches(step, border, entries); });
}

}  // namespace

template <class T>
CrossBorder<T> border_kernel() {
  return cross_border<T>;
}
template CrossBorder<float> border_kernel();
template CrossBorder<double> border_kernel();

}  // namespace silt::lbm::SILT_BUILD
