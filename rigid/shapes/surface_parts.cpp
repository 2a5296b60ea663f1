#include "rigid/shapes/surface_parts.hpp"

#include <algorithm>

#include "rigid/shapes/shape.hpp"

namespace silt::rigid {

namespace {

/// Collects the parts and planes that a shape's member `surface` adds.
template <class T>
class Preparation {
 public:
  /// Prepares the parts of a body with this orientation.
  Preparation(const Quat& orientation, std::vector<SurfacePart<T>>& parts, std::vector<Plane<T>>& planes)
      : to_body_(orientation.toRotationMatrix().transpose()), parts_(parts), planes_(planes) {}

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
    add(kind, axes(), centre(), size, extent);
  }
  /// Adds a part whose centre is the point `at` of the shape's frame.
  void add_shifted(SurfaceKind kind, const Vec3& at, const Vec3& size) {
    add(kind, axes(), centre() + at, size, size);
  }
  /// Adds a part of spherical symmetry: its axes are those of the world.
  void add_unturned(SurfaceKind kind, const Vec3& size) {
    add(kind, Mat3::Identity(), to_body_.transpose() * part_.position, size, size);
  }
  /// Adds a part of size 1 in coordinates multiplied by `scale` along its axes.
  void add_scaled(SurfaceKind kind, const Vec3& scale) {
    add(kind, scale.asDiagonal() * axes(), scale.asDiagonal() * centre(), Vec3::Ones(), Vec3::Ones());
  }
  /// Adds a plane to the last added part.
  void add_plane(const Vec3& normal, double offset) {
    planes_.push_back({{T(normal[0]), T(normal[1]), T(normal[2])}, T(offset)});
    ++parts_.back().planes;
  }

 private:
  Mat3 to_part() const { return part_.orientation.toRotationMatrix().transpose(); }
  Mat3 axes() const { return to_part() * to_body_; }
  Vec3 centre() const { return to_part() * part_.position; }

  void add(SurfaceKind kind, const Mat3& axes, const Vec3& centre, const Vec3& size, const Vec3& extent) {
    SurfacePart<T> part{};
    part.kind = kind;
    part.first_plane = std::uint32_t(planes_.size());
    for (int k = 0; k < 3; ++k) {
      part.centre[k] = T(centre[k]);
      part.size[k] = T(size[k]);
      part.extent[k] = T(extent[k]);
      for (int d = 0; d < 3; ++d) part.axes[k][d] = T(axes(k, d));
    }
    parts_.push_back(part);
  }

  Mat3 to_body_;
  Pose part_;  // to the body
  std::vector<SurfacePart<T>>& parts_;
  std::vector<Plane<T>>& planes_;
};

}  // namespace

template <class T>
void SurfaceParts<T>::reset(const Shape& shape, const Quat& orientation) {
  parts_.clear();
  planes_.clear();
  std::visit(Preparation<T>(orientation, parts_, planes_), shape);
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
