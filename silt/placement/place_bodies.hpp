#pragma once
// Places the bodies of a case on their ranks: at the start, and when fills are applied during a run.
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
  std::uint64_t total = 0, refused = 0;  // on all ranks: placed, and without room
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

/// This rank's bodies at the start, by centre of mass. Ids count from 1: given bodies in the order of the
/// case, then those of each fill, ordered so that close ids are mostly close bodies.
class PlacedBodies {
 public:
  std::size_t size() const;
  /// Calls f(id, spec) by id. Centres of mass of filled bodies are in the domain.
  template <class F>
  void for_each(F&& f) const {
    for (const GivenBody& body : given) f(body.id, body.spec);
    for (const AppliedFill& fill : filled) fill.for_each(f);
  }

  std::vector<GivenBody> given;
  std::vector<AppliedFill> filled;  // in the order of the case
  rigid::BodyId next_id = 1;        // the first unused id
};

/// Places the bodies of a case; bitwise the same on any number of ranks and for any blocks. The bounding
/// sphere of a filled body (about its centre of mass), grown by the fill's gap, touches no wall, no given or
/// existing body and no other bounding sphere, and lies in the fill's box. Larger spheres are placed first
/// (random sequential addition jams near 38 % of the box in bounding spheres). Fills on sites take the first
/// free ones; fills may have equal seeds. `there` are this rank's existing bodies. Throws CaseError on every
/// rank, with the number that fitted. Collective.
PlacedBodies place_bodies(const Case&, const lbm::Domain&, MPI_Comm, const rigid::BodySet* there = nullptr);

/// Returns the fills that are applied again before step `steps_done + 1`.
std::vector<FillApplication> fills_due(const Case&, std::int64_t steps_done);

/// Places the bodies of these applications among existing ones (`bodies` are this rank's) as above. Each
/// application has its own random numbers. Collective.
std::vector<AppliedFill> place_arrivals(const Case&, const std::vector<FillApplication>&, const lbm::Domain&,
                                        MPI_Comm, const rigid::BodySet& bodies, rigid::BodyId& next_id);

struct Case;

/// A shape about its centre of mass, with its properties.
struct CentredShape {
  rigid::Shape shape;
  double volume = 0, bounding_radius = 0;
  rigid::Mat3 inertia = rigid::Mat3::Zero();  // for density 1
};
std::vector<CentredShape> centred_shapes(const Case&);

/// Returns the record of a body: pose of its centre of mass, not wrapped; buoyancy if in a fluid.
rigid::BodyRecord body_record(rigid::BodyId, const BodySpec&, const CentredShape&, bool in_fluid);

struct Case;

/// The start positions of bodies, distributed evenly over ranks by id modulo their number.
class StartPositions {
 public:
  /// Returns the centres of mass at the start, not wrapped, by id; NaN for unknown bodies. Collective.
  std::vector<rigid::Vec3> of(const Case&, const lbm::Domain&, MPI_Comm,
                              std::span<const rigid::BodyId>) const;

 private:
  struct Start {
    rigid::BodyId id;
    double position[3];
  };
  static std::vector<Start> met_here(const Case&, const lbm::Domain&, MPI_Comm);
  static Start found(const std::vector<Start>&, rigid::BodyId);

  mutable std::optional<std::vector<Start>> starts_;  // by id
};

}  // namespace silt
