#pragma once
// The figures of a run: [[quantities]] and [run.steady] of a case, and the types that an entry may have.
#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "coupler/spec/name_table.hpp"
#include "rigid/math/types.hpp"
#include "silt/case/units.hpp"

namespace silt {

enum class Axis { x, y, z };
inline constexpr auto axis_names = coupler::names_of<Axis>("x", "y", "z");

/// The components of a symmetric tensor.
enum class Component { xx, yy, zz, xy, xz, yz };
inline constexpr auto component_names = coupler::names_of<Component>("xx", "yy", "zz", "xy", "xz", "yz");

/// A force acts on bodies, on one of [[walls]] or on a side of the domain.
enum class Bearer { bodies, wall, side };

/// A value that the run writes to report.json under "quantities", for reference.toml. quantity_types lists
/// the types and their keys.
struct QuantitySpec {
  std::string name, type;
  Bearer bearer = Bearer::bodies;
  int kind = -1;  // index into Case::kind_names; -1: every body
  int axis = 2;
  double time = 0;    // start of the evaluation (of an instant: its time, by default the end), in steps
  double height = 0;  // along the axis: of bodies, of a plane
  double second_height = 0;  // of the second of two planes
  /// The steps of which the value is the mean, or the deviation.
  struct Over {
    double from, to;
    bool deviation;
    bool operator==(const Over&) const = default;
  };
  std::optional<Over> over;
  int side = 0;       // a Side of the domain
  int wall = 0;       // index into Case::walls
  int component = 0;  // a Component
  rigid::Vec3 centre = rigid::Vec3::Zero();
  rigid::BoundingBox box{rigid::Vec3::Zero(), rigid::Vec3::Zero()};

  bool is_about(int body_kind) const { return kind < 0 || body_kind == kind; }
  bool operator==(const QuantitySpec&) const = default;
};

/// Ends the run early when a quantity has come close to its limit (see SteadyWatch).
struct SteadySpec {
  std::string quantity;  // name of a QuantitySpec
  double change = 0;     // relative
  std::int64_t every = 0;
};

/// A type of [[quantities]] entries: its keys, needs of the scene, dimension and meaning.
struct QuantityType {
  enum Key : unsigned {
    body = 1,
    axis = 2,
    time = 4,  // from which on the run is evaluated
    height = 16,
    centre = 32,
    box = 64,
    side = 128,
    wall = 256,
    instant = 512,  // also the key `time`: the instant, by default the end
    at = 1024,
    bearer = 2048,      // body or wall
    side_bears = 4096,  // or side
    component = 8192,
    planes = 16384,  // written `at` too: two of them
  };
  enum Need : unsigned {
    fluid = 1,
    bodies = 2,
    gravity = 4,
    undriven = 8,      // no body of prescribed motion
    sheared = 16,      // walls of different velocities across `axis`
    same_bodies = 32,  // from start to end
    heat = 128,
    stepwise = 64  // not a need: has a value in every step without waiting
  };

  std::string_view name;
  Dimension dimension;  // of the value
  unsigned keys, needs;
  std::string_view meaning;
  std::string_view unit = "";  // of a value without a dimension

  constexpr bool takes(Key key) const { return keys & key; }
  constexpr bool asks_for(Need need) const { return needs & need; }
};
using Q = QuantityType;  // for rows

/// All types. Rows and computations are at the end of the families in silt/results.
extern const std::vector<QuantityType> quantity_types;

/// Returns a type by its name. Throws std::invalid_argument if there is none.
inline const QuantityType& quantity_type(std::string_view name) {
  for (const QuantityType& type : quantity_types)
    if (type.name == name) return type;
  throw std::invalid_argument("not a type of a quantity: " + std::string(name));
}

}  // namespace silt
