#pragma once
// Which row a body is in: a table of ids in one piece of memory, filled anew when rows change, which on many
// ranks is most steps, and asked several times a contact.
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "rigid/math/types.hpp"

namespace silt::rigid {

class RowTable {
 public:
  /// Row k is that of ids[k]; of equal ids the first.
  void assign(std::span<const BodyId> ids) {
    const std::size_t places = std::bit_ceil(2 * ids.size() + 1);
    places_.assign(places, {});
    shift_ = 64 - std::countr_zero(places);
    for (std::size_t row = 0; row < ids.size(); ++row) {
      Place& place = places_[of(ids[row])];
      if (place.row == none) place = {ids[row], row};
    }
  }
  /// The row of an id; `otherwise` if there is none.
  std::size_t find(BodyId id, std::size_t otherwise) const {
    if (places_.empty()) return otherwise;
    const Place& place = places_[of(id)];
    return place.row == none ? otherwise : place.row;
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  struct Place {
    BodyId id = 0;
    std::size_t row = none;
  };

  /// Where an id is, or would be. At most half of the places are taken.
  std::size_t of(BodyId id) const {
    constexpr std::uint64_t golden = 0x9E3779B97F4A7C15;  // spreads ids that follow one another
    std::size_t at = shift_ < 64 ? id * golden >> shift_ : 0;
    while (places_[at].row != none && places_[at].id != id) at = (at + 1) & (places_.size() - 1);
    return at;
  }

  std::vector<Place> places_;
  int shift_ = 64;
};

}  // namespace silt::rigid
