#pragma once
// The border between fine cells of one level and coarse cells of the next, which populations cross in packets
// (method.md, equation 30). A population that has left a coarse cell becomes eight packets, one for each fine
// cell in its place, which move by one fine cell in each of the two fine steps of a coarse step. A packet
// that enters a fine cell is the population that arrives there. A population that leaves the fine cells
// continues as a packet, and a coarse cell receives the mean of the packets that end in it. No packet is lost
// or counted twice, so mass and momentum are conserved.
//
// Lists are made for patches, rectangles of coarse cells with the same leaves of the tree of cuts around
// them: packets of the next cell do the same as its own, two fine cells further on (level_border_lists.cpp).
// Patches that go on from one another are then joined (join_patches.hpp).
#include <memory_resource>
#include <span>
#include <vector>

#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/fluid.hpp"
#include "lbm/passes/level_border_patches.hpp"

namespace silt::lbm {

/// Values that patches read in an array of their own: those of other ranks, or copies before they change.
template <class T>
struct FetchedSlots {
  SlotExchange<T> exchange;
  std::pmr::vector<T> values;
  std::uint32_t count = 0;  // of the values listed

  FetchedSlots(MPI_Comm comm, Device device, std::pmr::polymorphic_allocator<> memory)
      : exchange(comm, 5, device), values(memory) {}
  /// Fetches them; the arrays are those of a table, `values` among them.
  void fetch(std::span<T* const> arrays) { exchange.start(arrays), exchange.finish(arrays, arrays); }
};

/// `Field` holds the populations of a level: Fluid<T>, or a class with its blocks(), domain(), parity(),
/// passes(), device() and half_push().
template <class Field>
class LevelBorder {
  using T = typename Field::Number;
  using Lattice = typename Field::Lattice;

 public:
  /// Takes the fluids of a level and of the next coarser one, with the same tree of cuts. Refers to both.
  LevelBorder(Field& fine, Field& coarse);

  /// Call before the pass of the coarse fluid, and after its exchange.
  void before_coarse_pass();
  void after_coarse_pass();
  /// Call when a pass of the fine fluid begins, and after its exchange, for each of the two passes in a
  /// coarse step. Fine cells then receive what arrives in them; after the second pass coarse cells receive
  /// the packets that fine cells sent in both. after_part, called when a part of a block has collided, is
  /// optional and saves time, since the populations of the part are still cached.
  void begin_fine_pass();
  void after_part(int block, int part);
  void end_fine_pass();

 private:
  struct Builder;
  using Patches = BorderPatches<T>;
  using Patch = typename Patches::Patch;
  using Explosion = typename Patches::Explosion;
  using Coalescence = typename Patches::Coalescence;
  using Extent = typename Patches::Extent;
  using Lists = BorderLists<T>;

  LevelBorder(Field& fine, Field& coarse, std::pmr::polymorphic_allocator<> memory);
  void make_lists();  // level_border_lists.cpp
  void cross(const Lists&, std::span<const typename Patches::Passing>);

  Field &fine_, &coarse_;
  FetchedSlots<T> before_, coarse_left_, fine_left_[2];  // before_: of coarse cells, before they collide
  std::pmr::vector<T> carried_, sums_;
  /// The tables of patches by parity: arrays of the blocks, then the fetched arrays (and before_).
  std::pmr::vector<T*> coarse_arrays_[2], fine_arrays_[2];
  std::pmr::vector<typename Patches::Carried> carry_;
  std::pmr::vector<typename Patches::Passing> passing_;
  /// The lists of patches that can be served after a part of a block, by block and part; none if passes are
  /// not in parts. Patches that need several blocks or other ranks, or subtract others' values, are served
  /// late.
  std::vector<std::vector<Lists>> ready_;
  std::vector<char> by_parts_;  // whether after_part() was called for a block in this pass
  Lists late_;
  Patches now_{};  // of the current pass
};

}  // namespace silt::lbm
