#pragma once
// The bodies that a case gives one by one, on the ranks they concern.
#include <span>
#include <vector>

#include "coupler/case/case.hpp"
#include "coupler/placement/surroundings.hpp"

namespace silt::coupler {

/// Or one that is there already when others come.
struct GivenBody {
  rigid::BodyId id;
  BodySpec spec;
  bool own;  // its centre of mass is here
};

/// Collective. Returns the given bodies that this rank owns or that reach near it, in the order of ids: from
/// 1 on, first those whose positions the case says, then those of files, each in the order of the case.
std::vector<GivenBody> given_bodies(const Case&, Surroundings&);
/// Returns the mean diameter of their bounding spheres, at least a cell: what suits a grid of them.
double mean_width(const Case&, std::span<const GivenBody>);
/// Returns how many there are on all ranks.
std::uint64_t count_given(const Case&);
/// Returns which entry of [[bodies]] gave one.
int entry_of(const Case&, rigid::BodyId);

}  // namespace silt::coupler
