#pragma once
// A surface that answers at what distance links meet it.
#include "coupler/mapping/link_groups.hpp"
#include "coupler/mapping/mesh_distances.hpp"
#include "coupler/mapping/surface_kernels.hpp"
#include "coupler/mapping/surface_parts.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

template <class T>
class MeasuredSurface {
 public:
  MeasuredSurface(WallScheme scheme, MeshDistances& mesh)
      : follows_(lbm::follows_distance(scheme)), mesh_(mesh) {}

  void reset(const rigid::Shape& shape, const BlockMap& map, const BodyMask& mask,
             const lbm::SurfaceFrame& frame) {
    frame_ = &frame;
    if (!follows_) return;
    way_ = std::holds_alternative<rigid::Mesh>(shape) ? Way::mesh
           : rigid::is_endless(shape)                 ? Way::hollow
                                                      : Way::parts;
    if (way_ == Way::mesh)
      mesh_.find(std::get<rigid::Mesh>(shape), map, mask);
    else if (way_ == Way::hollow)
      hollow_.reset(shape, mask.pose.orientation);
    else
      parts_.reset(shape, mask.pose.orientation);
  }

  void measure(const LinkList<T>& links) {
    links.pad(links.place);
    const int padded = int(lbm::padded(links.n));
    if (!follows_)
      std::fill_n(links.q, links.n, T(0.5));
    else if (way_ == Way::mesh)
      mesh_.set(links.corner, links.place, links.n, links.q);
    else if (way_ == Way::hollow)
      distance_kernel<double, T>()(links.place, padded, *frame_, links.corner, hollow_.view(), 0.0, links.q);
    else
      distance_kernel<T, T>()(links.place, padded, *frame_, links.corner, parts_.view(), T(0), links.q);
  }

  /// Whether it has edges that links may cross.
  bool has_crossings() const { return follows_ && way_ == Way::parts && parts_.has_edges(); }
  SurfaceParts<T>& parts() { return parts_; }

 private:
  enum class Way { parts, hollow, mesh };

  bool follows_;  // else links meet it midway
  MeshDistances& mesh_;
  Way way_ = Way::parts;
  SurfaceParts<T> parts_;
  SurfaceParts<double> hollow_;  // in double: it may be far longer than anything else is wide
  const lbm::SurfaceFrame* frame_ = nullptr;
};

}  // namespace silt::coupler
