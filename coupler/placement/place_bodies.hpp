#pragma once
// The bodies of a case at the start, on the ranks where they will live.
#include <vector>

#include "coupler/case/body_spec.hpp"
#include "coupler/placement/filled_body.hpp"
#include "coupler/placement/given_bodies.hpp"

namespace silt::coupler {

/// This rank's bodies at the start: those whose centre of mass lies in its blocks. Ids count from 1: the
/// given bodies in the order of the case, then those of each fill, ordered so that close ids are mostly close
/// bodies.
class PlacedBodies {
 public:
  std::size_t size() const;
  /// Calls f(id, spec) in the order of ids. The poses are those of the shapes as the case gives them; those
  /// of fills are such that the centre of mass is in the domain.
  template <class F>
  void for_each(F&& f) const {
    for (const GivenBody& body : given) f(body.id, body.spec);
    for (const Filled& fill : filled)
      for (std::size_t i = 0; i < fill.bodies.size(); ++i) f(fill.first_id + fill.places[i], fill.spec(i));
  }

  struct Filled {  // by one fill
    BodySpec alike;
    rigid::Vec3 centre_of_mass;  // of the shape as the case gives it
    rigid::BodyId first_id;
    std::uint64_t total = 0;  // of all ranks
    std::vector<FilledBody> bodies;
    std::vector<std::uint64_t> places;  // of each among all of this fill
    BodySpec spec(std::size_t i) const;
  };
  std::vector<GivenBody> given;
  std::vector<Filled> filled;  // in the order of the case
};

/// Collective. The same bodies, to the bit, on any number of ranks and for any blocks. Each body of a fill is
/// put where its bounding sphere (about its centre of mass), grown by the fill's gap, meets no wall, no given
/// body and no bounding sphere of another filled body, and lies in the fill's box; those of the largest
/// spheres first (random sequential addition jams near 38 % of the box in bounding spheres). The seeds of two
/// fills may be equal. Fills on sites take those that are free, in order. CaseError on every rank, saying how
/// many fitted, if one does not fit.
PlacedBodies place_bodies(const Case&, const lbm::Domain&, MPI_Comm);

}  // namespace silt::coupler
