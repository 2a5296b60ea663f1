#pragma once
// The bodies of a case on the ranks where they will live: those of the start, and those that fills place
// while a run goes on.
#include <mpi.h>

#include <optional>
#include <span>
#include <vector>

#include "lbm/blocks/domain.hpp"
#include "rigid/bodies/body_set.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/one_fill.hpp"

namespace silt {

/// This rank's bodies of one application of a fill.
struct AppliedFill {
  BodySpec alike;
  rigid::BodyId first_id = 0;
  std::uint64_t total = 0, refused = 0;  // of all ranks: placed; asked for, but without room
  std::vector<FilledBody> bodies;

  template <class F>
  void for_each(F&& f) const {
    BodySpec body = alike;
    for (const FilledBody& filled : bodies) {
      body.pose = {filled.centre, filled.orientation};
      f(first_id + filled.place, body);
    }
  }
};

/// This rank's bodies at the start: those whose centre of mass lies in its blocks. Ids count from 1: the
/// given bodies in the order of the case, then those of each fill, ordered so that close ids are mostly close
/// bodies.
class PlacedBodies {
 public:
  std::size_t size() const;
  /// Calls f(id, spec) in the order of ids. The centres of mass of fills are in the domain.
  template <class F>
  void for_each(F&& f) const {
    for (const GivenBody& body : given) f(body.id, body.spec);
    for (const AppliedFill& fill : filled) fill.for_each(f);
  }

  std::vector<GivenBody> given;
  std::vector<AppliedFill> filled;  // in the order of the case
  rigid::BodyId next_id = 1;        // that no body of any rank has
};

/// Collective. Bitwise the same bodies on any number of ranks and for any blocks. Each body of a fill is
/// put where its bounding sphere (about its centre of mass), grown by the fill's gap, meets no wall, no given
/// body and no bounding sphere of another filled body, and lies in the fill's box; those of the largest
/// spheres first (random sequential addition jams near 38 % of the box in bounding spheres). The seeds of two
/// fills may be equal. Fills on sites take those that are free, in order. CaseError on every rank, saying how
/// many fitted, if one does not fit.
/// Fills find their places among those that are `there`, of which each rank has its own.
PlacedBodies place_bodies(const Case&, const lbm::Domain&, MPI_Comm, const rigid::BodySet* there = nullptr);

/// Returns the fills that are applied again before the step that follows so many.
std::vector<FillApplication> fills_due(const Case&, std::int64_t steps_done);

/// Collective. Places the bodies of these applications among those of all ranks, of which `bodies` has this
/// rank's, as above. Of the random numbers of an application no other has any.
std::vector<AppliedFill> place_arrivals(const Case&, const std::vector<FillApplication>&, const lbm::Domain&,
                                        MPI_Comm, const rigid::BodySet& bodies, rigid::BodyId& next_id);

struct Case;

/// A shape about its centre of mass, and what follows from it.
struct CentredShape {
  rigid::Shape shape;
  double volume = 0, bounding_radius = 0;
  rigid::Mat3 inertia = rigid::Mat3::Zero();  // of unit density
};
std::vector<CentredShape> centred_shapes(const Case&);

/// Returns a body as a record: the pose is that of its centre of mass, not wrapped; in a fluid of density 1
/// it has buoyancy.
rigid::BodyRecord body_record(rigid::BodyId, const BodySpec&, const CentredShape&, bool in_fluid);

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

}  // namespace silt
