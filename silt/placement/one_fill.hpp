#pragma once
// One application of a fill, and its two arrangements.
//
// On lattice sites each rank fills the free sites in its blocks.
//
// A random fill is parallel random sequential addition (method-parallel.md). Points are drawn in the room for
// centres; a point is accepted unless an earlier accepted point is closer than a diameter. Ranks draw the
// points of their own blocks and exchange those near borders. They decide points whose earlier neighbours are
// all decided, and exchange decisions until no point is open. Only the number of accepted points and the time
// of the last are global.
#include <vector>

#include "silt/case/fill_room.hpp"
#include "silt/placement/given_bodies.hpp"
#include "silt/placement/obstacles.hpp"

namespace silt {

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

}  // namespace silt
