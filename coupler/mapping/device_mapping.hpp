#pragma once
// Wall distances of links, their rates and the stiffness of bodies of convex parts as passes of a device
// (device/for_each.hpp): of all bodies of a block that are mapped at once, a team a group of links.
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "coupler/mapping/block_links.hpp"
#include "coupler/mapping/surface_primitives.hpp"
#include "device/device.hpp"

namespace silt::coupler {

/// A distance changes by at most this in half of the steps that a body is mapped for: a line that grazes the
/// surface may meet it at one time only.
inline constexpr double most_change = 0.25;

/// The rate of a distance which is `middle` in the middle of these steps, and `last` so many steps later.
/// Wall formulas amplify where a surface has come past a cell, q < 0: for a few steps they may.
template <class T>
SILT_DEVICE inline T rate_of(T middle, T last, double steps) {
  constexpr double few = 4;
  const T least = steps > few ? T(0) : T(-0.1), per_step = T(1 / steps);
  const T largest = T(most_change), most = std::min(largest, middle - least);
  return std::clamp(last - middle, -most, most) * per_step;
}

/// A surface at a time: where its parts and planes begin, and its frame.
struct SurfaceAtTime {
  std::uint32_t first_part, first_plane;
  int parts;
  lbm::SurfaceFrame frame;
};

template <class T>
struct SurfaceToMeasure {
  lbm::WallFluid<T> fluid;
  SurfaceAtTime now, last;  // in the middle of the steps that it is mapped for, and in the last of them
  double steps;             // between; 0: distances have no rates
  T arm;                    // of the stiffness (stiffness_exponent); 0: nobody asks for it
  lbm::StiffnessSums stiffness;
};

template <class T>
struct GroupToMeasure {
  std::uint32_t surface, count;
  lbm::WallScheme scheme;
  bool crossing;  // whose distances are known
  lbm::Int3 corner;
  const std::uint32_t* place;
  T *q, *rate;
};

/// The pass reads and writes these arrays.
template <class T>
struct MeasureLinks {
  GroupToMeasure<T>* groups;
  SurfaceToMeasure<T>* surfaces;
  const SurfacePart<T>* parts;
  const Plane<T>* planes;
  lbm::Components directions = lbm::components;
};

template <class T>
class DeviceMeasure {
 public:
  explicit DeviceMeasure(Device device) : device_(device) {}

  /// The distances of the surface's links are wanted. `arm` is that of SurfaceToMeasure.
  void add(SurfaceLinks<T>&, const SurfaceView<T>&, T arm);
  /// The rates of the surface added last are wanted as well, from how it will be after so many steps.
  void add_rates(const SurfaceView<T>&, const lbm::SurfaceFrame&, double steps);
  /// Sets all that is wanted. The surfaces have stayed where they were.
  void run();

 private:
  SurfaceAtTime listed(const SurfaceView<T>&, const lbm::SurfaceFrame&);

  Device device_;
  std::vector<SurfaceLinks<T>*> wanted_;
  std::pmr::vector<GroupToMeasure<T>> groups_{memory_of(device_)};
  std::pmr::vector<SurfaceToMeasure<T>> surfaces_{memory_of(device_)};
  std::pmr::vector<SurfacePart<T>> parts_{memory_of(device_)};
  std::pmr::vector<Plane<T>> planes_{memory_of(device_)};
};

namespace host {
template <class T>
void measure_links(std::size_t groups, const MeasureLinks<T>&);
}
namespace gpu {
template <class T>
void measure_links(std::size_t groups, const MeasureLinks<T>&);
}

}  // namespace silt::coupler
