#include "rigid/shapes/surface_parts.hpp"

#include <algorithm>

#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

namespace {

/// Collects the parts and planes that a shape's member `surface` adds.
template <class T>
class Preparation {
 public:
  Preparation(std::vector<ShapePart>& parts, std::vector<Plane<T>>& planes)
      : parts_(parts), planes_(planes) {}

  void operator()(const Compound& c) {
    for (const Part& part : c.parts) {
      part_ = part.pose;
      std::visit([&](const auto& shape) { shape.surface(*this); }, part.shape);
    }
  }
  void operator()(const Mesh&) {}  // triangles are handled elsewhere
  template <class S>
  void operator()(const S& shape) {
    shape.surface(*this);
  }

  /// Adds a part of this size in a box of half edges `extent`, by default equal to `size`.
  void add(SurfaceKind kind, const Vec3& size) { add(kind, size, size); }
  void add(SurfaceKind kind, const Vec3& size, const Vec3& extent) {
    add(kind, Vec3::Ones(), centre(), size, extent);
  }
  /// Adds a part whose centre is the point `at` of the shape's frame.
  void add_shifted(SurfaceKind kind, const Vec3& at, const Vec3& size) {
    add(kind, Vec3::Ones(), centre() + at, size, size);
  }
  /// Adds a part of spherical symmetry: its axes are those of the world.
  void add_unturned(SurfaceKind kind, const Vec3& size) {
    add(kind, Vec3::Ones(), part_.position, size, size);
    parts_.back().turns = false;
  }
  /// Adds a part of size 1 in coordinates multiplied by `scale` along its axes.
  void add_scaled(SurfaceKind kind, const Vec3& scale) {
    add(kind, scale, scale.asDiagonal() * centre(), Vec3::Ones(), Vec3::Ones());
  }
  /// Adds a plane to the last added part.
  void add_plane(const Vec3& normal, double offset) {
    planes_.push_back({{T(normal[0]), T(normal[1]), T(normal[2])}, T(offset)});
    ++parts_.back().planes;
  }

 private:
  Mat3 to_part() const { return part_.orientation.toRotationMatrix().transpose(); }
  Vec3 centre() const { return to_part() * part_.position; }

  void add(SurfaceKind kind, const Vec3& scale, const Vec3& centre, const Vec3& size, const Vec3& extent) {
    ShapePart part{};
    part.kind = kind, part.turns = true;
    part.first_plane = std::uint32_t(planes_.size());
    const Mat3 axes = to_part();
    for (int k = 0; k < 3; ++k) {
      part.scale[k] = scale[k], part.centre[k] = centre[k];
      part.size[k] = size[k], part.extent[k] = extent[k];
      for (int d = 0; d < 3; ++d) part.axes[k][d] = axes(k, d);
    }
    parts_.push_back(part);
  }

  Pose part_;  // to the body
  std::vector<ShapePart>& parts_;
  std::vector<Plane<T>>& planes_;
};

}  // namespace

template <class T>
void SurfaceParts<T>::reset(const Shape& shape, const Quat& orientation) {
  shape_.clear(), parts_.clear(), planes_.clear();
  std::visit(Preparation<T>(shape_, planes_), shape);
  const Rotation turn(turn_of(orientation));
  for (const ShapePart& part : shape_) parts_.push_back(turned<T>(part, turn));
}

template <class T>
bool SurfaceParts<T>::has_edges() const {
  return std::any_of(parts_.begin(), parts_.end(), [](const SurfacePart<T>& part) {
    return rigid::has_edges(part.kind) && part.planes != 1;
  });
}

template class SurfaceParts<float>;
template class SurfaceParts<double>;

}  // namespace silt::rigid
