#pragma once
// Fills, applied at the start or again later: the largest bodies first, each where there is room.
#include <vector>

#include "coupler/case/case.hpp"
#include "coupler/case/fill_room.hpp"
#include "coupler/placement/filled_body.hpp"
#include "coupler/placement/given_bodies.hpp"

namespace silt::coupler {

/// This rank's bodies of one application of a fill.
struct AppliedFill {
  BodySpec alike;
  rigid::BodyId first_id = 0;
  std::uint64_t total = 0, refused = 0;  // of all ranks: placed; asked for, but without room
  std::vector<FilledBody> bodies;
  std::vector<std::uint64_t> places;  // of each among all of this application

  BodySpec spec(std::size_t i) const;
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t i = 0; i < bodies.size(); ++i) f(first_id + places[i], spec(i));
  }
};

/// The furthest at which a body of any fill asks what is there.
double reach_of_fills(const Case&);

/// Collective. Applies fills, each body where its bounding sphere meets neither what is there, which each
/// rank knows within reach_of_fills of its blocks, nor another one. Ids count from `next_id` on in the order
/// of the applications, and `next_id` goes past them. CaseError on every rank if bodies of a first
/// application do not fit; at a later one those are left out.
std::vector<AppliedFill> apply_fills(const Case&, const std::vector<FillApplication>&,
                                     std::span<const GivenBody> there, Surroundings&, rigid::BodyId& next_id);

}  // namespace silt::coupler
