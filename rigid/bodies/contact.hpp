#pragma once
// A contact: what collision detection hands to a resolver.
#include <compare>
#include <cstdint>
#include <span>
#include <tuple>

#include "rigid/bodies/lubrication.hpp"
#include "rigid/math/types.hpp"

namespace silt::rigid {

/// One point of a contact between two shapes, in the frame the query was made in.
struct ContactPoint {
  Vec3 on_a, on_b;        // surface points: on_b - on_a = gap * normal
  Vec3 normal;            // unit, from a to b
  double gap;             // < 0: overlap
  std::uint64_t feature;  // stable from step to step for the same pair of features (vertex, edge, face)
};

/// An image names one of the periodic images of body b: -1, 0, 1 an axis.
struct Image {
  std::int8_t x = 0, y = 0, z = 0;
  auto operator<=>(const Image&) const = default;
};

/// Set in the feature of a contact with a lubrication film.
inline constexpr std::uint64_t lubrication_feature = std::uint64_t{1} << 63;

/// Packs which parts of two bodies a contact is between, and the feature of those, of 32 bits.
inline std::uint64_t packed_feature(std::size_t part_a, std::size_t part_b, std::uint64_t feature) {
  return std::uint64_t{part_a} << 48 | std::uint64_t{part_b} << 32 | feature;
}
/// Packs the part of one body and the feature of another that is a mesh and has no parts, of 52 bits.
inline std::uint64_t packed_mesh_feature(std::size_t part_of_other, std::uint64_t feature) {
  return std::uint64_t{part_of_other} << 52 | feature;
}
inline std::uint32_t feature_of(std::uint64_t packed) {
  return static_cast<std::uint32_t>(packed);
}

/// The principal radii of curvature of the gap between two surfaces (method-bodies.md, R3); 0 at an edge or a
/// corner.
struct ReducedRadii {
  double least = 0, largest = 0;
};

/// Which motion turns the normal of bodies that stay in contact: that of the centres of two spheres, or that
/// of the bodies whose faces it stands on.
enum class NormalTurns : std::uint8_t { never, with_centres, with_a, with_b, with_both };

struct Contact {
  BodyId a, b;            // a < b
  Image image;            // of b, relative to the canonical position of a
  std::uint64_t feature;  // lubrication_feature; part of a, part of b, feature of the parts
  Vec3 normal;            // unit, from a to b
  double gap;
  Vec3 r_a, r_b;  // where its impulse acts (method.md, C3a), from each centre of mass; of a tube
                  // from its axis abreast of a
  double restitution, friction;
  LubricationResistance lubrication = {};         // of the film in a narrow gap
  ReducedRadii radii = {};                        // where the pair's material asks for them
  NormalTurns normal_turns = NormalTurns::never;  // known of pairs that cohere

  auto pair() const { return std::tuple(a, b, image); }
  /// The order in which contacts are resolved and summed, on any number of ranks.
  auto key() const { return std::tuple(a, b, image, feature); }
};

/// Calls visit(k, contacts) for each pair of sorted contacts, k being the number of its first one.
template <class Visit>
void for_each_pair(std::span<const Contact> all, Visit&& visit) {
  for (std::size_t first = 0, last; first < all.size(); first = last) {
    for (last = first + 1; last < all.size() && all[last].pair() == all[first].pair();) ++last;
    visit(first, all.subspan(first, last - first));
  }
}

}  // namespace silt::rigid
