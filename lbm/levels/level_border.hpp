#pragma once
// The border between the cells of one level, fine, and those of the next, coarse: what crosses it goes in
// packets (method.md, equation 30). A coarse population that has left its cell is eight packets, one of each
// of the fine cells in its cell's place; they go on by a fine cell in each of the two fine steps of a coarse
// one. Those whose way enters a fine cell are what arrives there; a fine population that leaves the fine
// cells goes on as a packet; and a coarse cell receives the mean of the packets that end in it. So no packet
// is lost or counted twice, and mass and momentum are conserved.
//
// The lists are made for rows of coarse cells whose surroundings are the same leaves of the tree of cuts, so
// that what one cell of a row does the next does too, two fine cells further on (level_border_lists.cpp).
#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "lbm/exchange/slot_exchange.hpp"
#include "lbm/fluid.hpp"
#include "lbm/passes/level_border_rows.hpp"

namespace silt::lbm {

/// `Field` is what lies on a level of cells: Fluid<T>, or what has its blocks, domain, parity, passes,
/// device and half_push.
template <class Field>
class LevelBorder {
  using T = typename Field::Number;
  using Lattice = typename Field::Lattice;

 public:
  /// The fluids of a level and of the next coarser one, of one tree of cuts. Refers to both.
  LevelBorder(Field& fine, Field& coarse);

  /// Call before the pass of the coarse fluid, and when its exchange is done.
  void before_coarse_pass();
  void after_coarse_pass();
  /// Call around each of the two passes of the fine fluid in a coarse step: when the pass begins and when its
  /// exchange is done. Fine cells then receive what arrives in them; after the second pass coarse cells
  /// receive what the fine ones sent in both. A call of after_part, when a part of a block has collided, is
  /// optional and saves time: its populations are still in a cache.
  void begin_fine_pass();
  void after_part(int block, int part);
  void end_fine_pass();

 private:
  struct Builder;
  using Rows = BorderRows<T>;
  using Row = typename Rows::Row;
  using Explosion = typename Rows::Explosion;
  using Packet = typename Rows::Packet;
  using Coalescence = typename Rows::Coalescence;
  using Source = typename Rows::Source;
  using Taken = typename Rows::Taken;
  using Lists = BorderLists<T>;

  LevelBorder(Field& fine, Field& coarse, std::pmr::polymorphic_allocator<> memory);
  void make_lists();  // level_border_lists.cpp
  void cross(const Lists&, std::span<const typename Rows::Passing>);

  Field &fine_, &coarse_;
  SlotExchange<T> before_, coarse_left_, fine_left_[2];
  std::pmr::vector<T> coarse_before_, coarse_fetched_, fine_fetched_[2], carried_, sums_;
  /// The tables of rows, by parity, then coarse_fetched_ and coarse_before_, or fine_fetched_.
  std::pmr::vector<T*> coarse_arrays_[2], fine_arrays_[2];
  std::pmr::vector<typename Rows::Carried> carry_;
  std::pmr::vector<typename Rows::Passing> passing_;
  /// The lists for rows that are ready after a part of a block, by block and part; none if a pass is not in
  /// parts. Rows that need more than one block, or another rank, or that take from what others read, come
  /// after the pass.
  std::vector<std::vector<Lists>> ready_;
  std::vector<char> by_parts_;  // whether parts of a block were told of in this pass
  Lists late_;
  Rows now_{};  // of the pass at hand
};

}  // namespace silt::lbm
