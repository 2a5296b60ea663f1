#pragma once
// Values go from slots of arrays to slots of others, on this rank or another: ghost layers, pairs of links,
// the cells of another cut, moments of neighbours. Which slots is listed once, in runs; what the arrays are
// is said when something is to go, so that one list serves every array laid out alike. Who makes the lists
// sees to it that both ends of a message list its slots in one order.
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "parallel/transfers.hpp"

namespace silt::lbm {

/// Slots first, first + stride, ... of an array.
struct SlotRun {
  std::uint32_t array, first;
  std::int32_t stride = 1;
  std::uint32_t length = 1;

  /// Whether `next` follows at this stride, which it has too.
  bool goes_on_with(const SlotRun& next) const {
    return array == next.array && stride == next.stride &&
           first + std::int64_t{stride} * length == std::int64_t{next.first};
  }
};

/// Slots in the order in which they were added.
class SlotList {
 public:
  void add(const SlotRun& run) {
    slots_ += run.length;
    if (!runs_.empty() && runs_.back().goes_on_with(run))
      runs_.back().length += run.length;
    else
      runs_.push_back(run);
  }
  void clear() { runs_.clear(), slots_ = 0; }
  const std::vector<SlotRun>& runs() const { return runs_; }
  std::size_t slots() const { return slots_; }

 private:
  std::vector<SlotRun> runs_;
  std::size_t slots_ = 0;
};

/// Slots and where the value of each goes.
class SlotPairs {
 public:
  struct Pair {
    SlotRun from, to;
  };
  void add(const SlotRun& from, const SlotRun& to) {
    if (!pairs_.empty() && pairs_.back().from.goes_on_with(from) && pairs_.back().to.goes_on_with(to))
      pairs_.back().from.length += from.length, pairs_.back().to.length += to.length;
    else
      pairs_.push_back({from, to});
  }
  void clear() { pairs_.clear(); }
  /// Calls visit(from_array, from, to_array, to) for each pair.
  template <class Visit>
  void for_slots(Visit&& visit) const {
    for (const auto& [from, to] : pairs_)
      for (std::ptrdiff_t n = 0; n < from.length; ++n)
        visit(from.array, from.first + n * from.stride, to.array, to.first + n * to.stride);
  }
  /// Puts change(value) of each slot in its place; `back` goes the other way. Nothing goes to an array that
  /// is a null pointer.
  template <class T, class Change>
  void move(std::span<const T* const> sources, std::span<T* const> targets, bool back,
            Change&& change) const {
    for (const Pair& pair : pairs_) {
      const SlotRun &source = back ? pair.to : pair.from, &target = back ? pair.from : pair.to;
      if (!targets[target.array]) continue;
      const T* const from = sources[source.array] + source.first;
      T* const to = targets[target.array] + target.first;
      const std::ptrdiff_t s = source.stride, t = target.stride;
      if (s == 1 && t == 1)
        for (std::ptrdiff_t n = 0; n < source.length; ++n) to[n] = change(from[n]);
      else
        for (std::ptrdiff_t n = 0; n < source.length; ++n) to[n * t] = change(from[n * s]);
    }
  }

 private:
  std::vector<Pair> pairs_;
};

template <class T>
class SlotExchange {
 public:
  /// All messages go by this communicator and tag.
  SlotExchange(MPI_Comm comm, int tag) : transfers_(comm, tag) {}

  /// The lists: what goes from slot to slot on this rank, and what this one sends another and receives from
  /// it. An exchange may also go back: then received slots are sent, and sent ones received.
  SlotPairs& copied() { return copied_; }
  SlotList& sent(int rank) { return peers_[rank].list[0]; }
  SlotList& received(int rank) { return peers_[rank].list[1]; }
  /// What this one sends that rank is not there yet at start(): it sets out in finish().
  void hold_back(int rank) { peers_[rank].early = false; }
  /// Empties all lists.
  void clear();

  /// Sends from these arrays, and awaits what comes.
  void start(std::span<const T* const> sources, bool back = false);
  /// Gives the messages under way a chance to move.
  void progress() { transfers_.progress(); }
  /// Does what is left. Nothing goes to an array that is a null pointer; what would have is lost.
  void finish(std::span<const T* const> sources, std::span<T* const> targets, bool back = false);

  /// The bytes that this rank sends in one exchange, or those of them that set out in start().
  std::size_t message_bytes(bool early_alone = false) const;

 private:
  struct Peer {
    bool early = true;
    SlotList list[2];          // sent, received
    std::vector<T> buffer[2];  // of the lists
  };

  void send(std::span<const T* const> sources, bool back, bool early);

  SlotPairs copied_;
  std::map<int, Peer> peers_;  // by rank
  parallel::Transfers transfers_;
};

}  // namespace silt::lbm
