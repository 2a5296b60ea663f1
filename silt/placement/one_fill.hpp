#pragma once
// One application of a fill, and the two ways in which its bodies find their places.
//
// On the sites of a lattice each rank takes those of its blocks that are free.
//
// A fill at random is random sequential addition on many ranks (method-parallel.md): points rain on the room
// for the bodies' centres, and a point stays by the earlier points less than a diameter away. Ranks draw the
// points of their own blocks, tell those near a border to the ranks there, and decide points of which all
// such points are decided, to and fro until none is left. All ranks learn only how many have stayed, and when
// the last one fell.
#include <vector>

#include "silt/case/fill_room.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/obstacles.hpp"

namespace silt {

struct FilledBody {
  std::uint64_t number;  // unlike that of any other of the fill; bodies close together have close numbers
  rigid::Vec3 centre;    // of its bounding sphere and of mass; wrapped
  rigid::Quat orientation = rigid::Quat::Identity();
  std::uint64_t place = 0;  // among all bodies of this application
};

/// An application under way. Balls of its radius have been begun in the obstacles, to which the bodies placed
/// here and near are added.
struct OneFill {
  const Case& setup;
  FillApplication application;
  const FillSpec& spec;
  std::int64_t count;  // of this size; 0: as many as there are sites for
  double radius;       // of the bounding sphere
  Surroundings& around;
  Obstacles& obstacles;
};

/// Collective. Return this rank's bodies in the order of their numbers and how many all ranks have placed,
/// bitwise the same bodies on any number of ranks. If they do not all fit: CaseError on every rank at the
/// first application; at a later one there are fewer.
struct Filling {
  std::vector<FilledBody> bodies;
  std::uint64_t total;
};
Filling fill_sites(const OneFill&);
Filling fill_at_random(const OneFill&);

/// Collective. Returns for each of this rank's keys, which are sorted, below `range` and unlike all others on
/// any rank, how many keys of all ranks are smaller. Each rank counts a slice of the range: none holds more
/// than that.
std::vector<std::uint64_t> number_off(parallel::Messages&, const std::vector<std::uint64_t>& keys,
                                      std::uint64_t range);

/// Collective. Numbers the bodies of all ranks, whose own numbers are below `range`, from 0 on in their
/// order.
void set_places(std::vector<FilledBody>&, std::uint64_t range, Surroundings&);

}  // namespace silt
