#pragma once
// Contacts, as collision detection passes them to a resolver.
#include <compare>
#include <cstdint>
#include <span>
#include <tuple>

#include "rigid/bodies/lubrication.hpp"
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// One contact point of two shapes, in the frame of the query.
struct ContactPoint {
  Vec3 on_a, on_b;        // surface points: on_b - on_a = gap * normal
  Vec3 normal;            // unit, from a to b
  double gap;             // < 0: overlap
  std::uint64_t feature;  // constant over steps for the same pair of features (vertex, edge, face)
};

/// The number of a periodic image of body b: -1, 0 or 1 for each axis.
struct Image {
  std::int8_t x = 0, y = 0, z = 0;
  auto operator<=>(const Image&) const = default;
};

/// A bit of the feature, set for contacts with a lubrication film.
inline constexpr std::uint64_t lubrication_feature = std::uint64_t{1} << 63;

/// Packs the parts of two bodies and their feature of 32 bits.
inline std::uint64_t packed_feature(std::size_t part_a, std::size_t part_b, std::uint64_t feature) {
  return std::uint64_t{part_a} << 48 | std::uint64_t{part_b} << 32 | feature;
}
/// Packs the part of a body and the feature, of 52 bits, of a mesh, which has no parts.
inline std::uint64_t packed_mesh_feature(std::size_t part_of_other, std::uint64_t feature) {
  return std::uint64_t{part_of_other} << 52 | feature;
}
inline std::uint32_t feature_of(std::uint64_t packed) {
  return static_cast<std::uint32_t>(packed);
}

/// The principal radii of curvature of the gap (method-bodies.md, R3); 0 at edges and corners.
struct ReducedRadii {
  double least = 0, largest = 0;
};

/// What rotates the normal of a persistent contact: two spheres' centres, or bodies by their faces.
enum class NormalTurns : std::uint8_t { never, with_centres, with_a, with_b, with_both };

struct Contact {
  BodyId a, b;            // a < b
  Image image;            // of b, relative to the canonical position of a
  std::uint64_t feature;  // lubrication_feature; part of a, part of b, feature of the parts
  Vec3 normal;            // unit, from a to b
  double gap;
  Vec3 r_a, r_b;  // point of action (method.md, C3a) relative to the centres of mass; of a tube, relative to
                  // the point of its axis next to a
  double restitution, friction;
  LubricationResistance lubrication = {};         // of the lubrication film in a narrow gap
  ReducedRadii radii = {};                        // set where the pair's material needs them
  NormalTurns normal_turns = NormalTurns::never;  // set for cohesive pairs

  auto pair() const { return std::tuple(a, b, image); }
  /// The order in which contacts are solved and summed on any number of ranks, in which films make no
  /// difference.
  auto key() const { return std::tuple(a, b, image, feature & ~lubrication_feature); }
};

/// Calls visit(k, contacts) for each pair of bodies in sorted contacts; k is the index of its first contact.
template <class Visit>
void for_each_pair(std::span<const Contact> all, Visit&& visit) {
  for (std::size_t first = 0, last; first < all.size(); first = last) {
    for (last = first + 1; last < all.size() && all[last].pair() == all[first].pair();) ++last;
    visit(first, all.subspan(first, last - first));
  }
}

}  // namespace silt::rigid
