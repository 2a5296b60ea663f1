#pragma once
// The border between the cells of one level, fine, and those of the next, coarse: what crosses it goes in
// packets (README.md, "Levels"). A coarse population that has left its cell is eight packets, one of each of
// the fine cells in its cell's place; they go on by a fine cell in each of the two fine steps of a coarse
// one. Those whose way enters a fine cell are what arrives there; a fine population that leaves the fine
// cells goes on as a packet; and a coarse cell receives the mean of the packets that end in it. So no packet
// is lost or counted twice, and mass and momentum are conserved.
//
// The lists are made for rows of coarse cells whose surroundings are the same leaves of the tree of cuts, so
// that what one cell of a row does the next does too, two fine cells further on (level_border_lists.cpp).
#include <array>
#include <cstdint>
#include <vector>

#include "lbm/fluid.hpp"
#include "lbm/slot_exchange.hpp"

namespace silt::lbm {

template <class T>
class LevelBorder {
 public:
  /// The fluids of a level and of the next coarser one, of one tree of cuts. Refers to both.
  LevelBorder(Fluid<T>& fine, Fluid<T>& coarse);

  /// Call before the pass of the coarse fluid, and when its exchange is done.
  void before_coarse_pass();
  void after_coarse_pass();
  /// Call around both passes of the fine fluid in a coarse step: when one begins, if you like when a part of
  /// a block has collided, and when its exchange is done. What arrives in fine cells is given them; the
  /// second time coarse cells too receive what the fine ones sent in this coarse step. After a part what is
  /// there of it is still in a cache: at faces across x each population is in a cache line of its own.
  void begin_fine_pass();
  void after_part(int block, int part);
  void end_fine_pass();

 private:
  struct Builder;
  /// Elements of an array of a table, one for each coarse cell of a row. Tables have the arrays of all
  /// directions of the blocks of a fluid, block * directions + i; of the coarse one those of what left, then
  /// of what arrives; then what was fetched from other ranks.
  struct Row {
    std::uint32_t array = 0;
    std::int32_t first = 0, step = 0;
  };
  /// What the packets carry that leave a row of coarse cells along one direction: rows beside one another.
  struct Carried {
    std::uint32_t length, first;  // first: in carried_
    Row value;
    std::array<Row, 3> above, below;  // beside it along each axis; itself where no coarse cell is
    std::array<T, 3> slope;           // times their difference: the change to a packet's place
    std::int32_t before;  // in coarse_before_, what had arrived in the first cell; -1: does not count
  };
  static constexpr int carried_rows =
      5;  // populations of the first step, of the second; changes along x, y, z
  /// An explosion is that of coarse populations of one direction that left a row of cells, into fine cells.
  struct Explosion {
    std::uint32_t length, carried;
    std::array<std::uint8_t, 2> packets;  // how many, by sub-step
  };
  struct Packet {
    Row to;
    T addend;             // by walls that it met, and the force
    std::uint8_t corner;  // bit d for the upper half along axis d
    bool paired = false;  // the next element is for the other corner along x
  };
  /// A coalescence is what arrives along one direction in a row of coarse cells.
  struct Coalescence {
    std::uint32_t length;
    Row to;
    std::uint32_t sum;  // in sums_, of the first sub-step's
    T addend;
    std::uint8_t from_coarse;             // packets of the eight
    std::array<std::uint8_t, 2> sources;  // how many, by sub-step
    std::uint8_t taken;                   // how many
  };
  struct Source {  // in fine cells
    Row from;
    bool paired = false;  // the next element is one more
  };
  /// By packets that entered fine cells, beyond the value in the middle of their cell.
  struct Taken {
    Row above, below;
    T factor;
  };
  /// Packets that pass between two fine cells.
  struct Passing {
    std::uint32_t length;
    Row from, to;
    std::uint32_t kept;  // in sums_
    T addend;
  };

  /// The list says which of them are ready after a part of a block; those that need more than one block, or
  /// what was fetched from other ranks, and those that take from what others read, come after the pass.
  struct Ready {
    std::vector<Explosion> explosions;
    std::vector<Packet> packets[2];  // those of one explosion after those of another, by sub-step
    std::vector<Coalescence> coalescences;
    std::vector<Source> sources[2];
    std::vector<Taken> taken;
  };

  void carry(const Carried&);
  void explode(const Explosion&, const Packet*);
  void coalesce(const Coalescence&, const Source*, const Taken*);
  void do_ready(const Ready&);

  Fluid<T>&fine_, &coarse_;
  SlotExchange<T> before_, coarse_left_, fine_left_[2];
  std::vector<T> coarse_before_, coarse_fetched_, fine_fetched_[2], carried_, sums_;
  std::vector<Carried> carry_;
  std::vector<Passing> passing_;
  std::vector<std::vector<Ready>> ready_;  // by block and part
  std::vector<char> by_parts_;             // whether parts of a block were told of in this pass
  Ready late_;
  struct {  // of the pass at hand
    int sub_step = 0;
    std::vector<T*> fine_arriving, coarse_arriving;
    std::vector<const T*> fine_left, coarse_left;
  } now_;
};

}  // namespace silt::lbm
