#pragma once
// Decodes the places of a vector of links (cut_links.hpp).
#include "cpu/lanes.hpp"
#include "lbm/walls/cut_links.hpp"

namespace silt::lbm::SILT_BUILD {

template <class Whole>
SILT_DEVICE Whole component(const Whole& packed, int d) {
  return packed << (30 - 2 * d) >> 30;
}

/// The origin of the places of a group.
template <class T>
struct PlaceOrigin {
  Int3 corner;                       // of the group, relative to cell `frame.cell`
  T offset[3];                       // from the reference point to the centre of that cell
  const std::int32_t (&packed)[32];  // Components::packed
  std::int32_t row, plane;           // offsets between rows and planes of cells
  SILT_DEVICE PlaceOrigin(Int3 corner, const SurfaceFrame& frame, const std::int32_t (&packed)[32],
                          std::int32_t row = 0, std::int32_t plane = 0)
      : corner(corner - frame.cell),
        offset{T(frame.offset[0]), T(frame.offset[1]), T(frame.offset[2])},
        packed(packed),
        row(row),
        plane(plane) {}
#if !defined(SILT_SCALAR)
  PlaceOrigin(Int3 corner, const SurfaceFrame& frame)
      : PlaceOrigin(corner, frame, components<D3Q19>.packed) {}
#endif
};

/// The wall distances of a group in the current step.
template <class T>
class WallDistances {
 public:
  using V = typename Lanes<T>::Real;
  SILT_DEVICE WallDistances(const T* q, const T* rate, T age) : q_(q), rate_(rate), age_(age) {}
  WallDistances(const CutLinks<T>& links, const LinkGroup& group)
      : WallDistances(links.q.data() + group.begin,
                      links.rate.empty() ? nullptr : links.rate.data() + group.begin, links.age) {}
  /// Returns the wall distances of the vector of links from l on.
  SILT_DEVICE V at(int l) const {
    const V q = load<V>(q_ + l);
    return rate_ ? q + age_ * load<V>(rate_ + l) : q;
  }

 private:
  const T *q_, *rate_;
  T age_;
};

template <class T>
struct Places {
  using L = Lanes<T>;
  using V = typename L::Real;
  typename L::Whole cell, direction;  // cell: offset from the group's corner
  V r[3], c[3];                       // arm from the reference point; components of the direction

  SILT_DEVICE Places(const std::uint32_t* places, const PlaceOrigin<T>& origin) {
    const auto place = load<typename L::Whole>(places);
    const auto x = place & ((1 << place_x_bits) - 1), y = (place >> place_x_bits) & ((1 << place_y_bits) - 1),
               z = (place >> place_z_shift) & ((1 << place_z_bits) - 1);
    direction = (place >> place_direction_shift) & 31;
    cell = x + origin.row * y + origin.plane * z;
    r[0] = L::real(x + origin.corner.x) + origin.offset[0];
    r[1] = L::real(y + origin.corner.y) + origin.offset[1];
    r[2] = L::real(z + origin.corner.z) + origin.offset[2];
    const auto packed = L::look_up(origin.packed, direction);
    for (int d = 0; d < 3; ++d) c[d] = L::real(component(packed, d));
  }
  /// Returns the slot of one population per link, from a table by direction.
  SILT_DEVICE typename L::Whole slots(const std::int32_t (&table)[32]) const {
    return L::look_up(table, direction) + cell;
  }
  SILT_DEVICE V along(const V& x, const V& y, const V& z) const { return c[0] * x + c[1] * y + c[2] * z; }
  /// Returns 6 w of the directions, of which the first six are along axes.
  SILT_DEVICE V weight6() const {
    return L::mask(direction > 6) ? V{} + T(6 * D3Q19::w(7)) : V{} + T(6 * D3Q19::w(1));
  }
};

}  // namespace silt::lbm::SILT_BUILD
