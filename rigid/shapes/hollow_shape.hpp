#pragma once
// Walls round about what is inside: not convex, of infinite mass, so no collision backend sees them
// (rigid/collision/hollow_contacts.hpp). README.md of this folder says how to add one.
#include <concepts>
#include <variant>

#include "rigid/shapes/tube.hpp"

namespace silt::rigid {

/// Every hollow has the following members, in its own frame, whose z axis is the one that it may turn about:
/// - name: what a case calls its type;
/// - fields: a tuple of Field, its sizes as a case gives them;
/// - slides: whether it is alike all along its axis, and so may slide along it;
/// - signed_distance(x): from x to its surface, negative in the wall; exact;
/// - gap(pose, x) and outward(pose, x): the same distance and the unit direction to the nearest point of the
/// wall, in the frame that the pose is given in;
/// - ray_distance(o, d, t_max): how far along o + t d, from a point in the hole, the wall is;
/// - curvature(n): the curvature tensor of the surface where its normal is n, out of the wall: not above
/// zero;
/// - hole(pose): a box about the hole, along the axes of the frame of the pose;
/// - innermost(x): a point as deep in the hole as any, near to x;
/// - widest(): the radius of the largest ball in the hole; area(axis, size): of its surface within a box of
/// this size, about;
/// - surface(parts): how mapping sees it, by a kind of coupler/mapping/surface_primitives.hpp that is hollow.
template <class H>
concept HollowSolid = requires(const H& hollow, const Vec3& x, const Pose& pose) {
  requires std::equality_comparable<H>;
  { H::name } -> std::convertible_to<std::string_view>;
  std::tuple_size<std::remove_cvref_t<decltype(H::fields)>>::value;
  { H::slides } -> std::convertible_to<bool>;
  { hollow.signed_distance(x) } -> std::same_as<double>;
  { hollow.gap(pose, x) } -> std::same_as<double>;
  { hollow.outward(pose, x) } -> std::same_as<Vec3>;
  { hollow.ray_distance(x, x, 1.0) } -> std::same_as<double>;
  { hollow.curvature(x) } -> std::same_as<Mat3>;
  { hollow.hole(pose) } -> std::same_as<BoundingBox>;
  { hollow.innermost(x) } -> std::same_as<Vec3>;
  { hollow.widest() } -> std::same_as<double>;
  { hollow.area(x, x) } -> std::same_as<double>;
};

template <HollowSolid... H>
using HollowShapes = std::variant<H...>;

struct HollowShape : HollowShapes<Tube> {
  using variant::variant;
  bool operator==(const HollowShape&) const = default;

  std::string_view name() const {
    return std::visit([]<class H>(const H&) { return H::name; }, *this);
  }
  /// Calls use(key, size) for its sizes, as a case gives them.
  template <class Use>
  void for_sizes(Use&& use) const {
    std::visit(
        [&]<class H>(const H& h) {
          std::apply([&](const auto&... field) { (use(field.key, h.*field.member / field.share), ...); },
                     H::fields);
        },
        *this);
  }
  double gap(const Pose& pose, const Vec3& x) const {
    return std::visit([&](const auto& h) { return h.gap(pose, x); }, *this);
  }
  Mat3 curvature(const Vec3& n_B) const {
    return std::visit([&](const auto& h) { return h.curvature(n_B); }, *this);
  }
  BoundingBox hole(const Pose& pose) const {
    return std::visit([&](const auto& h) { return h.hole(pose); }, *this);
  }
  Vec3 innermost(const Vec3& x_B) const {
    return std::visit([&](const auto& h) { return h.innermost(x_B); }, *this);
  }
  double area(const Vec3& axis, const Vec3& size) const {
    return std::visit([&](const auto& h) { return h.area(axis, size); }, *this);
  }
  double widest() const {
    return std::visit([](const auto& h) { return h.widest(); }, *this);
  }
  /// Says whether it is alike all along its axis.
  bool slides() const {
    return std::visit([]<class H>(const H&) { return H::slides; }, *this);
  }
};

}  // namespace silt::rigid
