#pragma once
// Names of the shapes, for headers that only refer to them.

namespace silt::rigid {

struct Shape;
struct ConvexShape;
struct Part;
struct HalfSpace;
struct HollowShape;
struct Mesh;
struct BoundingBox;
struct MassProperties;

}  // namespace silt::rigid
