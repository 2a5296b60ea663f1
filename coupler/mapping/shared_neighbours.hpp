#pragma once
// Exchanges values of pairs of a cell that turned solid or fluid and a neighbour on another rank: moments go
// to the rank of the cell, masses to that of the neighbour (refill.hpp). Both ends find the pairs in their
// maps.
#include <mpi.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "coupler/mapping/solid_map.hpp"
#include "lbm/blocks/domain.hpp"
#include "lbm/exchange/slot_exchange.hpp"

namespace silt::coupler {

/// Calls visit(cell) for the ghost cells of a block whose bit is set in bits(y, z, k), word k of a row.
template <class Bits, class Visit>
void for_ghosts(const BlockMap& map, Bits&& bits, Visit&& visit) {
  if (!map.changed) return;
  for (int z = -1; z <= map.box.size.z; ++z)
    for (int y = -1; y <= map.box.size.y; ++y)
      for (int k = 0; k < map.solid.words(); ++k)
        if (const std::uint64_t found = bits(y, z, k))
          for_bits(found, k, [&](int x) {
            if (!map.has({x, y, z})) visit(lbm::Int3{x, y, z});
          });
}

/// The pairs with each rank, ordered by changed cell and direction to the neighbour, as the other end orders
/// them. A value is a struct of doubles.
template <class Value>
class SharedNeighbours {
 public:
  explicit SharedNeighbours(const lbm::Domain& domain) : domain_(domain) {}

  /// Adds the pair of a cell (global, not wrapped) and its neighbour along c_k; the next value belongs to it.
  void add(int rank, lbm::Int3 cell, int k) {
    const lbm::Int3 g = domain_.wrapped(cell), n = domain_.cells();
    pairs_.push_back({rank, (std::int64_t(g.z) * n.y + g.y) * n.x + g.x, k, std::uint32_t(pairs_.size())});
  }
  std::size_t size() const { return pairs_.size(); }

  /// Sends the values of these pairs and returns those of the pairs `wanted`. Collective over the ranks of
  /// neighbouring blocks.
  std::vector<Value> exchange(MPI_Comm comm, int tag, std::span<const Value> values,
                              SharedNeighbours& wanted) {
    std::sort(pairs_.begin(), pairs_.end());
    std::sort(wanted.pairs_.begin(), wanted.pairs_.end());
    std::vector<Value> found(wanted.size());
    lbm::SlotExchange<double> slots(comm, tag);
    for (const Pair& p : pairs_) slots.sent(p.rank).add(p.slots());
    for (const Pair& p : wanted.pairs_) slots.received(p.rank).add(p.slots());
    const double* const from = reinterpret_cast<const double*>(values.data());
    double* const to = reinterpret_cast<double*>(found.data());
    slots.start({&from, 1});
    slots.finish({&from, 1}, {&to, 1});
    return found;
  }

 private:
  struct Pair {
    int rank;
    std::int64_t cell;  // index in the domain
    int direction;
    std::uint32_t place;  // index of the value
    bool operator<(const Pair& other) const {
      return std::tie(rank, cell, direction) < std::tie(other.rank, other.cell, other.direction);
    }
    lbm::SlotRun slots() const {
      constexpr std::uint32_t numbers = sizeof(Value) / sizeof(double);
      return {0, numbers * place, 1, numbers};
    }
  };

  const lbm::Domain& domain_;
  std::vector<Pair> pairs_;
};

}  // namespace silt::coupler
