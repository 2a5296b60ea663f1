// Built once per instruction set: the resistance of a surface from its links.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "lbm/walls/link_resistance.hpp"

namespace silt::lbm::SILT_BUILD {
namespace {

constexpr int entries = resistance_entries + push_entries;

template <class T>
using Entries = typename Lanes<T>::Quanta[entries];

/// Adds the resistance of a group; in single precision terms are summed in 32 bits.
template <class T>
void add_group(const CutLinks<T>& links, const LinkGroup& group, int exponent, Entries<T>& sums) {
  using L = Lanes<T>;
  using V = typename L::Real;
  using Terms = std::conditional_t<sizeof(T) == 4, typename L::Whole, typename L::Quanta>;
  constexpr int chunk = 64 * L::count;  // links whose terms fit the sums, 64 per lane
  const PlaceOrigin<T> origin(group.corner, links.frame);
  const std::uint32_t* const place = links.place.data() + group.begin;
  const int count = int(group.count);
  const T arm = T(std::ldexp(1.0, -exponent));
  for (int first = 0; first < count; first += chunk) {
    Terms h[entries] = {};
    for (int l = first; l < std::min(first + chunk, count); l += L::count) {
      const Places<T> at(place + l, origin);
      add_resistance<T>(at, L::below(count - l), arm,
                        [&](int e, const V& term) { h[e] += __builtin_convertvector(term, Terms); });
    }
    for (int e = 0; e < entries; ++e) sums[e] += __builtin_convertvector(h[e], typename L::Quanta);
  }
}

template <class T>
ResistanceSums of_links(const CutLinks<T>& links, int exponent) {
  Entries<T> lanes = {};
  for (const LinkGroup& group : links.groups) add_group(links, group, exponent, lanes);
  const auto total = [&](int e) {
    std::int64_t sum = 0;
    for (int l = 0; l < Lanes<T>::count; ++l) sum += lanes[e][l];
    return sum;
  };
  ResistanceSums sums;
  for (int e = 0; e < resistance_entries; ++e) sums.h[e] = total(e);
  for (int e = resistance_entries; e < entries; ++e) sums.push[e - resistance_entries] = total(e);
  return sums;
}

}  // namespace

template <class T>
Resistance<T> resistance() {
  return of_links<T>;
}
template Resistance<float> resistance();
template Resistance<double> resistance();

}  // namespace silt::lbm::SILT_BUILD
