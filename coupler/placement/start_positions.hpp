#pragma once
// The ranks that have bodies now can ask where these were at the start: the case tells, not memory.
#include <mpi.h>

#include <optional>
#include <span>
#include <vector>

#include "lbm/domain.hpp"
#include "rigid/bodies/contact.hpp"

namespace silt::coupler {

struct Case;

/// Ranks that placed bodies and those that ask meet at the rank id modulo ranks: none holds more than its
/// share, from the first question on.
class StartPositions {
 public:
  /// Collective. Returns the centres of mass at the start, not wrapped, of bodies by their ids; NaN for one
  /// that was not there.
  std::vector<rigid::Vec3> of(const Case&, const lbm::Domain&, MPI_Comm,
                              std::span<const rigid::BodyId>) const;

 private:
  struct Start {
    rigid::BodyId id;
    double position[3];
  };
  static std::vector<Start> met_here(const Case&, const lbm::Domain&, MPI_Comm);
  static Start found(const std::vector<Start>&, rigid::BodyId);

  mutable std::optional<std::vector<Start>> starts_;  // in the order of ids
};

}  // namespace silt::coupler
