#pragma once
// The passes over a border between levels for builds for a device (SILT_BUILD): a team of threads handles a
// patch, its members take the cells in turn.
#include "device/for_each.hpp"
#include "lbm/passes/cross_border.hpp"

namespace silt::lbm::SILT_BUILD {

template <class Step, class T, class Entry>
struct OverPatches {
  BorderPatches<T> border;
  const Entry* entries;
  SILT_DEVICE void operator()(std::int64_t k, Team team) const {
    const Entry& entry = entries[k];
    if (team.size == 1) return Step()(border, entry, PatchPart::all_of(entry.size));
    for (std::ptrdiff_t n = team.lane; n < std::ptrdiff_t(entry.size.cells()); n += team.size)
      Step()(border, entry, PatchPart::cell_of(entry.size, n));
  }
};
struct ByTeams {
  template <class Step, class T, class Entries>
  void operator()(const Step&, const BorderPatches<T>& border, const Entries& entries) const {
    using Entry = std::remove_cvref_t<decltype(*entries.data())>;
    for_teams(std::int64_t(entries.size()), OverPatches<Step, T, Entry>{border, entries.data()});
  }
};

template <class T>
void carry_packets(const BorderPatches<T>& border,
                   std::span<const typename BorderPatches<T>::Carried> carried) {
  carry_over<ByTeams>(border, carried);
}
template <class T>
void cross_border(const BorderPatches<T>& border, const BorderLists<T>& lists,
                  std::span<const typename BorderPatches<T>::Passing> passing) {
  cross_over<ByTeams>(border, lists, passing);
  silt::SILT_BUILD::wait();
}

}  // namespace silt::lbm::SILT_BUILD
