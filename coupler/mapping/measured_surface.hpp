#pragma once
// Measures the distances at which links meet a surface, and their rates while the surface moves: until the
// next mapping the distances follow it to first order.
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/device_mapping.hpp"
#include "coupler/mapping/link_groups.hpp"
#include "coupler/mapping/mesh_distances.hpp"
#include "coupler/mapping/surface_distance.hpp"
#include "rigid/shapes/shape.hpp"
#include "rigid/shapes/surface_parts.hpp"

namespace silt::coupler {

template <class T>
class MeasuredSurface {
 public:
  /// Leaves distances to bodies with convex parts to `device` if links are built there.
  MeasuredSurface(WallScheme scheme, MeshDistances& mesh, DeviceMapping<T>& device)
      : follows_(lbm::follows_distance(scheme)), mesh_(mesh), device_(device) {}

  void reset(const rigid::Shape& shape, const BlockMap& map, const BodyMask& mask,
             const lbm::SurfaceFrame& frame) {
    frame_ = &frame;
    if (!follows_) return;
    way_ = std::holds_alternative<rigid::Mesh>(shape)   ? Way::mesh
           : std::holds_alternative<rigid::Tube>(shape) ? Way::tube
                                                        : Way::parts;
    if (way_ == Way::mesh)
      mesh_.find(std::get<rigid::Mesh>(shape), map, mask);
    else if (way_ == Way::tube)
      tube_.reset(shape, mask.pose.orientation);
    else
      parts_.reset(shape, mask.pose.orientation);
  }

  void measure(const LinkList<T>& list) {
    list.pad(list.place);
    const PlacedLinks links{list.place, int(lbm::padded(list.n)), list.corner};
    if (!follows_)
      std::fill_n(list.q, list.n, T(0.5));
    else if (way_ == Way::mesh)
      mesh_.set(list.corner, list.place, list.n, list.q);
    else if (way_ == Way::tube)
      distance_kernel<double, T>()(links, *frame_, tube_.view(), 0.0, list.q);
    else
      distance_kernel<T, T>()(links, *frame_, parts_.view(), T(0), list.q);
  }
  bool leaves_to_device(const rigid::Shape& shape) const {
    return device_.has_links() && (!follows_ || !(std::holds_alternative<rigid::Mesh>(shape) ||
                                                  std::holds_alternative<rigid::Tube>(shape)));
  }
  /// Queues the n-th surface that the device has counted: its groups, distances, rates and resistance.
  void leave_to_device(SurfaceLinks<T>& surface, std::size_t n, const rigid::Quat& orientation,
                       const MappedMotion& mapped, T arm) {
    surface.links.rate.clear();
    device_.add(surface, n, parts_.shape(), rigid::turn_of(orientation), arm);
    const double steps = steps_with_rates(surface.links, mapped);
    if (steps == 0) return;
    device_.add_rates(rigid::turn_of(mapped.pose_after(steps).orientation),
                      frame_after(surface.links.frame, mapped, steps), steps);
  }

  /// Sets the rates of links, which were built for the middle of the mapping's steps, from their distances in
  /// the last step; no rates if the body is at rest or mapped for one step. Crossing links keep their
  /// distances, on which their existence depends.
  void set_rates(lbm::CutLinks<T>& links, const rigid::Shape& shape, const MappedMotion& mapped) {
    links.rate.clear();
    const double steps = steps_with_rates(links, mapped);
    if (steps == 0) return;
    parts_.reset(shape, mapped.pose_after(steps).orientation);
    const lbm::SurfaceFrame frame = frame_after(links.frame, mapped, steps);
    links.rate.assign(links.q.size(), T(0));
    for (const lbm::LinkGroup& group : links.groups) {
      if (group.crossing) continue;
      const int padded = int(lbm::padded(group.count));
      T* const last = links.rate.data() + group.begin;
      distance_kernel<T, T>()({links.place.data() + group.begin, padded, group.corner}, frame, parts_.view(),
                              T(most_change), last);
      const T* const middle = links.q.data() + group.begin;
      for (int l = 0; l < padded; ++l) last[l] = rate_of<T>(middle[l], last[l], steps);
    }
  }

  /// Returns whether the surface has edges that links may cross.
  bool has_crossings() const { return follows_ && way_ == Way::parts && parts_.has_edges(); }
  rigid::SurfaceView<T> view() const { return parts_.view(); }
  rigid::ShapeView<T> shape() const { return parts_.shape(); }

 private:
  enum class Way { parts, tube, mesh };
  /// Returns the steps from the middle of a mapping's steps to the last; 0 if distances do not change.
  double steps_with_rates(const lbm::CutLinks<T>& links, const MappedMotion& mapped) const {
    const double steps = static_cast<double>(mapped.steps.end - 1) - mapped.middle();
    return !follows_ || mapped.is_at_rest() || links.q.empty() || !(steps > 0) ? 0 : steps;
  }
  static lbm::SurfaceFrame frame_after(lbm::SurfaceFrame frame, const MappedMotion& mapped, double steps) {
    for (int d = 0; d < 3; ++d) frame.offset[d] -= steps * mapped.velocity.numbers[d];
    return frame;
  }

  bool follows_;  // else links meet it midway
  MeshDistances& mesh_;
  DeviceMapping<T>& device_;
  Way way_ = Way::parts;
  rigid::SurfaceParts<T> parts_;
  rigid::SurfaceParts<double> tube_;  // in double, as it may be very long
  const lbm::SurfaceFrame* frame_ = nullptr;
};

}  // namespace silt::coupler
