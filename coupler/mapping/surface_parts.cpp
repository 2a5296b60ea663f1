#include "coupler/mapping/surface_parts.hpp"

#include <limits>

namespace silt::coupler {

using rigid::Mat3;
using rigid::Vec3;

namespace {

template <class T>
class Preparation {
 public:
  /// For a body so oriented.
  Preparation(const rigid::Quat& orientation, std::vector<SurfacePart<T>>& parts,
              std::vector<Plane<T>>& planes)
      : to_body_(orientation.toRotationMatrix().transpose()), parts_(parts), planes_(planes) {}

  void operator()(const rigid::Compound& c) {
    for (const rigid::Part& part : c.parts) {
      part_ = part.pose;
      std::visit([&](const auto& shape) { (*this)(shape); }, part.shape);
    }
  }
  void operator()(const rigid::Sphere& s) {
    add(PartKind::sphere, Mat3::Identity(), to_body_.transpose() * part_.position, Vec3::Constant(s.radius));
  }
  /// In its half axes it is the unit ball.
  void operator()(const rigid::Ellipsoid& e) {
    const auto scale = e.half_axes.cwiseInverse().asDiagonal();
    add(PartKind::ellipsoid, scale * axes(), scale * centre(), Vec3::Ones());
  }
  void operator()(const rigid::Box& b) { add(PartKind::box, axes(), centre(), b.half_edges); }
  void operator()(const rigid::Capsule& c) {
    add(PartKind::capsule, axes(), centre(), {c.radius, c.radius, c.half_length},
        {c.radius, c.radius, c.radius + c.half_length});
  }
  void operator()(const rigid::Cylinder& c) {
    add(PartKind::cylinder, axes(), centre(), {c.radius, c.radius, c.half_length});
  }
  void operator()(const rigid::Polyhedron& p) {
    Vec3 low = p.mesh->vertices.front(), high = low;
    for (const Vec3& v : p.mesh->vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    const Vec3 middle = 0.5 * (low + high);
    SurfacePart<T>& part = add(PartKind::planes, axes(), centre() + middle, 0.5 * (high - low));
    for (const auto& face : p.mesh->faces)
      add_plane(part, face.normal, face.offset - face.normal.dot(middle));
  }
  void operator()(const rigid::HalfSpace& h) {
    add_plane(add(PartKind::planes, axes(), centre(), endless), h.normal, 0);
  }
  void operator()(const rigid::Tube& t) {
    add(PartKind::hollow, axes(), centre(), {t.radius, t.radius, 0}, endless);
  }

 private:
  static inline const Vec3 endless = Vec3::Constant(std::numeric_limits<double>::infinity());

  Mat3 to_part() const { return part_.orientation.toRotationMatrix().transpose(); }
  Mat3 axes() const { return to_part() * to_body_; }
  Vec3 centre() const { return to_part() * part_.position; }

  SurfacePart<T>& add(PartKind kind, const Mat3& axes, const Vec3& centre, const Vec3& size) {
    return add(kind, axes, centre, size, size);
  }
  SurfacePart<T>& add(PartKind kind, const Mat3& axes, const Vec3& centre, const Vec3& size,
                      const Vec3& extent) {
    SurfacePart<T> part{};
    part.kind = kind, part.first_plane = std::uint32_t(planes_.size());
    for (int k = 0; k < 3; ++k) {
      part.centre[k] = T(centre[k]), part.size[k] = T(size[k]), part.extent[k] = T(extent[k]);
      for (int d = 0; d < 3; ++d) part.axes[k][d] = T(axes(k, d));
    }
    return parts_.emplace_back(part);
  }
  void add_plane(SurfacePart<T>& part, const Vec3& normal, double offset) {
    planes_.push_back({{T(normal[0]), T(normal[1]), T(normal[2])}, T(offset)});
    ++part.planes;
  }

  Mat3 to_body_;
  rigid::Pose part_;  // to the body
  std::vector<SurfacePart<T>>& parts_;
  std::vector<Plane<T>>& planes_;
};

}  // namespace

template <class T>
void SurfaceParts<T>::reset(const rigid::Shape& shape, const rigid::Quat& orientation) {
  parts_.clear(), planes_.clear();
  std::visit(Preparation<T>(orientation, parts_, planes_), shape);
}

template class SurfaceParts<float>;
template class SurfaceParts<double>;

}  // namespace silt::coupler
