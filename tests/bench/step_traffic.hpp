#pragma once
// What a rank sends in a step, counted on paper: from the boxes of cells and the bodies' places, without
// asking what sends it.
#include <set>

#include "lbm/blocks/domain.hpp"
#include "silt/simulation.hpp"

namespace silt::bench {

struct Sent {
  double messages = 0, bytes = 0;
  Sent& operator+=(const Sent& more) {
    messages += more.messages, bytes += more.bytes;
    return *this;
  }
};

/// The populations that leave a rank's box into another one's, and those it takes from there, half of either
/// in a step (halo.hpp); `number`: bytes of one. Of a domain periodic along all axes, one block a rank.
Sent halo_sent(const lbm::Domain&, int rank, int number);
/// Two populations for each cut link from a cell of another rank whose cell behind is here
/// (pairs_across.hpp), in the next step. Of spheres.
Sent pairs_sent(const Simulation&, int number);
/// Counts the other ranks that have a cell less than `reach` away from the rank's box.
int ranks_within(const lbm::Domain&, int rank, double reach);
/// The other ranks that own a body of which there is a copy here.
std::set<int> copied_from(const Simulation&);
/// The other ranks that have to get a copy of a body owned here, `ahead` steps from now at present
/// velocities.
std::set<int> copied_to(const Simulation&, double ahead);

}  // namespace silt::bench
