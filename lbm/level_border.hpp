#pragma once
// The border between the cells of one level, fine, and those of the next, coarse: what crosses it goes in
// packets (README.md, "Levels"). A coarse population that has left its cell is eight packets, one of each of
// the fine cells in its cell's place; they go on by a fine cell in each of the two fine steps of a coarse
// one. Those whose way enters a fine cell are what arrives there; a fine population that leaves the fine
// cells goes on as a packet; and a coarse cell receives the mean of the packets that end in it. So no packet
// is lost or counted twice, and mass and momentum are conserved.
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
  /// Call when the exchange of the fine fluid is done, twice in a coarse step: what arrives in fine cells is
  /// given them; the second time coarse cells too receive what the fine ones sent in this coarse step.
  void after_fine_pass();

 private:
  struct Builder;
  /// Elements of arrays, for the n-th of a row of cells first + n step. Arrays are numbered block *
  /// directions + i.
  template <int count>
  struct Places {
    std::array<std::int32_t, count> first, step{};
    std::int32_t of(int k, std::uint32_t n) const { return first[k] + std::int32_t(n) * step[k]; }
  };
  /// The change of coarse populations from the middle of a cell to a packet in its corner at (1, 1, 1), along
  /// each axis: factor (values[plus] - values[minus]).
  struct Packet {  // of each coarse cell of a row, into a fine one
    std::uint32_t array;
    std::uint8_t sub_step, corner;  // corner: bit d for the upper half along axis d
    T addend;                       // by walls that it met
    bool operator==(const Packet&) const = default;
  };
  /// Coarse populations of one direction that left a row of cells.
  struct Explosion {
    enum { value, before, plus, minus = plus + 3, target = minus + 3, places = target + 8 };
    Places<places> at;  // in coarse_values_; in `before` of it; of each packet in its array
    std::uint32_t length;
    std::array<T, 3> slope;
    bool in_time;
    std::vector<Packet> packets;
  };
  /// What arrives along one direction in a row of coarse cells.
  struct Coalescence {
    enum { target, packet, places = packet + 8 };
    Places<places> at;  // in the array; in fine_values_
    std::uint32_t length, array;
    int packets;  // of fine cells
    T addend;     // of walls, to their mean
    struct Taken {
      std::int32_t plus, minus;
      T factor;
    };
    std::vector<Taken>
        taken;  // by packets that entered fine cells, beyond the value in the middle of the cell
  };
  /// A packet that passed between two fine cells.
  struct Passing {
    std::uint32_t array;
    std::int32_t target, value;
    T addend;
  };

  void explode(int sub_step);
  void coalesce();

  Fluid<T>&fine_, &coarse_;
  SlotExchange<T> before_, coarse_left_, fine_left_[2];
  std::vector<T> coarse_before_, coarse_values_, fine_values_;  // fetched
  std::vector<Explosion> explosions_;
  std::vector<Coalescence> coalescences_;
  std::vector<Passing> passing_;
};

}  // namespace silt::lbm
