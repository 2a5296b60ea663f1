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
    frame_ = frame, reflection_ = mask.reflection;
    if (!follows_) return;
    if (reflection_.any()) frame_ = surface_frame(mask.frame(), centre_in(map, mask, {}));
    way_ = std::holds_alternative<rigid::Mesh>(shape)   ? Way::mesh
           : std::holds_alternative<rigid::Tube>(shape) ? Way::tube
                                                        : Way::parts;
    if (way_ == Way::mesh)
      mesh_.find(std::get<rigid::Mesh>(shape), map, mask);
    else if (way_ == Way::tube)
      exact_.reset(shape, mask.pose.orientation);
    else
      parts_.reset(shape, mask.pose.orientation);
  }

  void measure(const LinkList<T>& list) {
    list.pad(list.place);
    if (!follows_)
      std::fill_n(list.q, list.n, T(0.5));
    else if (way_ == Way::mesh)
      mesh_.set(list.corner, list.place, list.n, list.q);
    else if (way_ == Way::tube)
      distance_kernel<double, T>()(reflected({list.place, int(lbm::padded(list.n)), list.corner}), frame_,
                                   exact_.view(), 0.0, list.q);
    else
      distance_kernel<T, T>()(reflected({list.place, int(lbm::padded(list.n)), list.corner}), frame_,
                              parts_.view(), T(0), list.q);
  }
  bool leaves_to_device(const rigid::Shape& shape) const {
    return device_.has_links() && (!follows_ || !(std::holds_alternative<rigid::Mesh>(shape) ||
                                                  std::holds_alternative<rigid::Tube>(shape)));
  }
  /// Queues a surface whose cells and links the device finds.
  void leave_to_device(SurfaceLinks<T>& surface, const rigid::Shape& shape, const BodyMask& mask,
                       const MappedMotion& mapped, T arm) {
    const bool is_mesh = std::holds_alternative<rigid::Mesh>(shape);
    if (!is_mesh && surface.device.parts.empty()) {
      parts_.reset(shape, mask.pose.orientation), exact_.reset(shape, mask.pose.orientation);
      device_.tell_shape(surface, parts_, exact_);
    }
    const Marking marking = is_mesh                                        ? Marking::told
                            : std::holds_alternative<rigid::Sphere>(shape) ? Marking::ball
                                                                           : Marking::parts;
    SurfaceToMap<T>& to = device_.add(surface, mask, marking, rigid::turn_of(mask.pose.orientation));
    to.arm = arm, to.middle = mapped.middle(), to.steps = steps_with_rates(mapped);
    if (to.steps == 0) return;
    std::ranges::copy(mapped.velocity.linear(), to.velocity);
    to.last = device_.turned(surface, rigid::turn_of(mapped.pose_after(to.steps).orientation));
  }

  /// Sets the rates of links, which were built for the middle of the mapping's steps, from their distances in
  /// the last step; no rates if the body is at rest or mapped for one step. Crossing links keep their
  /// distances, on which their existence depends.
  void set_rates(lbm::CutLinks<T>& links, const rigid::Shape& shape, const MappedMotion& mapped) {
    links.rate.clear();
    const double steps = steps_with_rates(mapped);
    if (steps == 0 || links.q.empty()) return;
    parts_.reset(shape, mapped.pose_after(steps).orientation);
    double velocity[3];
    std::ranges::copy(mapped.velocity.linear(), velocity);
    const lbm::SurfaceFrame frame = frame_after(frame_, velocity, steps);
    links.rate.assign(links.q.size(), T(0));
    for (const lbm::LinkGroup& group : links.groups) {
      if (group.crossing) continue;
      const int padded = int(lbm::padded(group.count));
      T* const last = links.rate.data() + group.begin;
      distance_kernel<T, T>()(reflected({links.place.data() + group.begin, padded, group.corner}), frame,
                              parts_.view(), T(most_change), last);
      const T* const middle = links.q.data() + group.begin;
      for (int l = 0; l < padded; ++l) last[l] = rate_of<T>(middle[l], last[l], steps);
    }
  }

  /// Returns whether the surface has edges that links may cross.
  bool has_crossings() const {
    return follows_ && !reflection_.any() && way_ == Way::parts && parts_.has_edges();
  }
  rigid::SurfaceView<T> view() const { return parts_.view(); }

 private:
  enum class Way { parts, tube, mesh };
  /// Returns the steps from the middle of a mapping's steps to the last; 0 if distances do not change.
  double steps_with_rates(const MappedMotion& mapped) const {
    const double steps = static_cast<double>(mapped.steps.end - 1) - mapped.middle();
    return !follows_ || mapped.is_at_rest() || !(steps > 0) ? 0 : steps;
  }

  /// Returns the links that a surface sees beyond its mirror: they begin in the cells at the side.
  PlacedLinks reflected(PlacedLinks links) {
    if (!reflection_.any()) return links;
    links.corner = links.corner + reflection_.side;
    beyond_.assign(links.place, links.place + links.padded);
    for (std::uint32_t& place : beyond_)
      place = lbm::link_place(
          lbm::place_cell(place),
          lbm::direction_of<lbm::D3Q19>(reflection_.direction(lbm::D3Q19::c[lbm::place_direction(place)])));
    links.place = beyond_.data();
    return links;
  }

  bool follows_;  // else links meet it midway
  MeshDistances& mesh_;
  DeviceMapping<T>& device_;
  Way way_ = Way::parts;
  rigid::SurfaceParts<T> parts_;
  rigid::SurfaceParts<double> exact_;  // of a tube, as it may be very long, and to mark cells
  lbm::SurfaceFrame frame_{};          // of the surface, which is not reflected: its links are
  Reflection reflection_;
  std::vector<std::uint32_t> beyond_;  // places of reflected links
};

}  // namespace silt::coupler
