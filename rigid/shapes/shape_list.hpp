#pragma once
// The shapes of a scene, for headers that hold them: who only passes them on need not know what a shape is.
#include <vector>

#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

struct ShapeList : std::vector<Shape> {
  ShapeList();
  ShapeList(std::initializer_list<Shape>);
  ShapeList(const ShapeList&);
  ShapeList(ShapeList&&) noexcept;
  ShapeList& operator=(const ShapeList&);
  ShapeList& operator=(ShapeList&&) noexcept;
  ~ShapeList();
};

}  // namespace silt::rigid
