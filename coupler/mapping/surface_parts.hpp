#pragma once
// The parts of a body's surface for the kernels of object mapping, made once a mapping of the body.
#include <vector>

#include "coupler/mapping/surface_primitives.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::coupler {

template <class T>
class SurfaceParts {
 public:
  /// Keeps nothing of what it was made of before but the memory.
  void reset(const rigid::Shape&, const rigid::Quat& orientation);
  /// Returns whether some part has convex edges.
  bool has_edges() const;
  SurfaceView<T> view() const { return {parts_.data(), int(parts_.size()), planes_.data()}; }

 private:
  std::vector<SurfacePart<T>> parts_;
  std::vector<Plane<T>> planes_;
};

}  // namespace silt::coupler
