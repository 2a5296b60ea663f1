#include "rigid/shapes/shape_list.hpp"

#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

ShapeList::ShapeList() = default;
ShapeList::ShapeList(std::initializer_list<Shape> shapes) : vector(shapes) {}
ShapeList::ShapeList(const ShapeList&) = default;
ShapeList::ShapeList(ShapeList&&) noexcept = default;
ShapeList& ShapeList::operator=(const ShapeList&) = default;
ShapeList& ShapeList::operator=(ShapeList&&) noexcept = default;
ShapeList::~ShapeList() = default;

}  // namespace silt::rigid
