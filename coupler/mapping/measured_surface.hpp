#pragma once
// A surface that answers at what distance links meet it, and how that changes while it moves on from where it
// was mapped: in the steps until it is mapped again its links follow it, to first order.
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/mapping/link_groups.hpp"
#include "coupler/mapping/mesh_distances.hpp"
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

  void measure(const LinkList<T>& list) {
    list.pad(list.place);
    const PlacedLinks links{list.place, int(lbm::padded(list.n)), list.corner};
    if (!follows_)
      std::fill_n(list.q, list.n, T(0.5));
    else if (way_ == Way::mesh)
      mesh_.set(list.corner, list.place, list.n, list.q);
    else if (way_ == Way::hollow)
      distance_kernel<double, T>()(links, *frame_, hollow_.view(), 0.0, list.q);
    else
      distance_kernel<T, T>()(links, *frame_, parts_.view(), T(0), list.q);
  }

  /// Sets the rates of links, built in the middle of the body's steps, by their distances in the last of
  /// these; of none if it is at rest or mapped for one step. Crossing links keep their distances: whether
  /// there is one at all depends on them.
  void set_rates(lbm::CutLinks<T>& links, const rigid::Shape& shape, const MappedMotion& mapped) {
    links.rate.clear();
    const double steps = static_cast<double>(mapped.end - 1) - mapped.middle();
    if (mapped.is_at_rest() || links.q.empty() || !(steps > 0)) return;
    parts_.reset(shape, mapped.pose_after(steps).orientation);
    lbm::SurfaceFrame frame = links.frame;
    for (int d = 0; d < 3; ++d) frame.offset[d] -= steps * mapped.velocity[d];
    links.rate.assign(links.q.size(), T(0));
    for (const lbm::LinkGroup& group : links.groups) {
      if (group.crossing) continue;
      const int padded = int(lbm::padded(group.count));
      T* const last = links.rate.data() + group.begin;
      distance_kernel<T, T>()({links.place.data() + group.begin, padded, group.corner}, frame, parts_.view(),
                              most_change, last);
      change_a_step(links.q.data() + group.begin, padded, steps, last);
    }
  }

  /// Whether it has edges that links may cross.
  bool has_crossings() const { return follows_ && way_ == Way::parts && parts_.has_edges(); }
  SurfaceView<T> view() const { return parts_.view(); }

 private:
  enum class Way { parts, hollow, mesh };
  /// Of a distance in half of the steps: a line that grazes the surface may meet it at one time only.
  static constexpr T most_change = T(0.25);

  /// Turns distances so many steps after the middle into rates. Where a surface comes past a cell, q < 0,
  /// wall formulas amplify: for a few steps they may.
  static void change_a_step(const T* middle, int links, double steps, T* last) {
    constexpr double few = 4;
    const T least = steps > few ? T(0) : T(-0.1), per_step = T(1 / steps);
    for (int l = 0; l < links; ++l) {
      const T most = std::min(most_change, middle[l] - least);
      last[l] = std::clamp(last[l] - middle[l], -most, most) * per_step;
    }
  }

  bool follows_;  // else links meet it midway
  MeshDistances& mesh_;
  Way way_ = Way::parts;
  SurfaceParts<T> parts_;
  SurfaceParts<double> hollow_;  // in double: it may be far longer than anything else is wide
  const lbm::SurfaceFrame* frame_ = nullptr;
};

}  // namespace silt::coupler
