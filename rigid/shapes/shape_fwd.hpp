#pragma once
// Forward declarations of the shapes, and a list of shapes of incomplete type.
#include <vector>

namespace silt::rigid {

struct Shape;
struct ConvexShape;
struct Part;
struct HalfSpace;
struct Tube;
struct Mesh;
struct BoundingBox;
struct MassProperties;

/// The shapes of a scene.
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
