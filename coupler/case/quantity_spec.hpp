#pragma once
// The figures of a run: [[quantities]] and [run.steady] of a case.
#include <cstdint>
#include <string>

#include "coupler/case/name_table.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

/// An analytic flow that a quantity compares with.
enum class Profile { channel, duct, pipe };
inline constexpr auto profile_names = names_of<Profile>("channel", "duct", "pipe");

/// A value the run puts into report.json under "quantities", for reference.toml to compare. The types and
/// the keys each takes are in quantity_types.
struct QuantitySpec {
  std::string name, type;
  int kind = -1;  // index into Case::kind_names; -1: every body
  int axis = 2;
  Profile profile = Profile::channel;
  double time = 0;    // from when on (of an instant: when; without one the end), in steps
  double height = 0;  // along the axis
  int side = 0;       // a Side of the domain
  int wall = 0;       // index into Case::walls
  rigid::Vec3 centre = rigid::Vec3::Zero();
  rigid::Vec3 lower = rigid::Vec3::Zero(), upper = rigid::Vec3::Zero();  // a box

  bool is_about(int body_kind) const { return kind < 0 || body_kind == kind; }
};

/// The run ends before its last step when a quantity has come so close to where it goes (see SteadyWatch).
struct SteadySpec {
  std::string quantity;  // name of a QuantitySpec
  double change = 0;     // relative
  std::int64_t every = 0;
};

}  // namespace silt::coupler
