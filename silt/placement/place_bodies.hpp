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
#include "silt/case/fill_room.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/obstacles.hpp"

namespace silt {

// One application of a fill, and its two arrangements.
//
// On lattice sites each rank fills the free sites in its blocks.
//
// A random fill is parallel random sequential addition (method-parallel.md). Points are drawn in the room for
// centres; a point is accepted unless an earlier accepted point is closer than a diameter. Ranks draw the
// points of their own blocks and exchange those near borders. They decide points whose earlier neighbours are
// all decided, and exchange decisions until no point is open. Only the number of accepted points and the time
// of the last are global.

struct FilledBody {
  std::uint64_t number;  // unique in the fill; close bodies have close numbers
  rigid::Vec3 centre;    // of bounding sphere and mass; wrapped
  rigid::Quat orientation = rigid::Quat::Identity();
  std::uint64_t place = 0;  // index among all bodies of this application
};

/// The current application. The obstacles have begun balls of its radius, to which bodies are added.
struct OneFill {
  const Case& setup;
  FillApplication application;
  const FillSpec& spec;
  std::int64_t count;  // of this size; 0: all sites
  double radius;       // of the bounding sphere
  Surroundings& around;
  Obstacles& obstacles;
};

/// Return this rank's bodies by number, and the number placed on all ranks; bitwise the same bodies on any
/// number of ranks. If not all fit: throw CaseError on every rank in the first application, place fewer in
/// later ones. Collective.
struct Filling {
  std::vector<FilledBody> bodies;
  std::uint64_t total;
};
Filling fill_sites(const OneFill&);
Filling fill_at_random(const OneFill&);

/// Returns for each of this rank's keys the number of smaller keys on all ranks. Keys must be sorted, below
/// `range` and globally unique. Each rank counts a slice of the range, which limits memory. Collective.
std::vector<std::uint64_t> number_off(parallel::Messages&, const std::vector<std::uint64_t>& keys,
                                      std::uint64_t range);

/// Sets the places of bodies: their order over all ranks by number, which is below `range`. Collective.
void set_places(std::vector<FilledBody>&, std::uint64_t range, Surroundings&);

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

/// A shape about its centre of mass, with its properties.
struct CentredShape {
  rigid::Shape shape;
  double volume = 0, bounding_radius = 0;
  rigid::Mat3 inertia = rigid::Mat3::Zero();  // for density 1
};
std::vector<CentredShape> centred_shapes(const Case&);

/// Returns the record of a body: pose of its centre of mass, not wrapped; buoyancy if in a fluid.
rigid::BodyRecord body_record(rigid::BodyId, const BodySpec&, const CentredShape&, bool in_fluid);

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
