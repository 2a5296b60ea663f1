#pragma once
// The surface of a body in a given orientation, prepared for kernels.
#include <vector>

#include "rigid/math/types.hpp"
#include "rigid/shapes/shape_fwd.hpp"
#include "rigid/shapes/surface_kinds.hpp"
#include "rigid/shapes/turned_parts.hpp"

namespace silt::rigid {

inline Turn turn_of(const Quat& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

template <class T>
class SurfaceParts {
 public:
  /// Replaces the surface; keeps the memory.
  void reset(const Shape&, const Quat& orientation);
  /// Returns whether some part has convex edges.
  bool has_edges() const;
  SurfaceView<T> view() const { return {parts_.data(), int(parts_.size()), planes_.data()}; }
  /// Returns the same parts before they were turned.
  ShapeView<T> shape() const { return {shape_.data(), int(shape_.size()), planes_.data()}; }

 private:
  std::vector<ShapePart> shape_;
  std::vector<SurfacePart<T>> parts_;
  std::vector<Plane<T>> planes_;
};

}  // namespace silt::rigid
