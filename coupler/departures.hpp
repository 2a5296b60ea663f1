#pragma once
// Bodies that leave the domain: by which way, and who has left.
#include <mpi.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rigid/bodies/contact.hpp"
#include "rigid/math/types.hpp"

namespace silt::coupler {

struct Case;

/// The ways out: 0 to 5 the sides of the domain, 6 + i the [[outflow]] i.
inline constexpr int first_outflow = 6;
/// Returns "z-high", "outflow[0]".
std::string way_text(int way);

/// A body that was taken out before the step that follows so many.
struct Departure {
  std::int64_t step;
  rigid::BodyId id;
  std::int64_t way;
  double position[3];  // of its centre of mass then
};

/// Returns the first side across a bounded axis that a ball is wholly beyond.
std::optional<int> side_behind(const Case&, const rigid::Vec3& centre, double radius);

/// Returns what to say of a body beyond a side that does not take it out, after so many steps.
std::string outside_text(const Case&, rigid::BodyId, bool free, int side, std::int64_t step);

/// Collective. Returns on rank 0 those of all ranks by step and id, nothing on the others.
std::vector<Departure> gathered(MPI_Comm, const std::vector<Departure>&);

}  // namespace silt::coupler
