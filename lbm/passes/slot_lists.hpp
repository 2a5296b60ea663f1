#pragma once
// Lists of slots of arrays, in runs, and of slots to which the values of others go. The arrays are named when
// values move, so that one list serves every array laid out alike.
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "cpu/device_code.hpp"
#include "device/mirror.hpp"

namespace silt::lbm {

/// Slots first, first + stride, ... of an array.
struct SlotRun {
  std::uint32_t array, first;
  std::int32_t stride = 1;
  std::uint32_t length = 1;

  /// Returns whether `next` follows at this stride, which it has too.
  bool goes_on_with(const SlotRun& next) const {
    return array == next.array && stride == next.stride &&
           first + std::int64_t{stride} * length == std::int64_t{next.first};
  }
};

/// The arrays that values come from or go to: a table of them, or one array for all.
template <class T>
struct SlotArrays {
  T* const* table = nullptr;
  T* only = nullptr;
  SILT_DEVICE T* operator[](std::uint32_t array) const { return table ? table[array] : only; }
};

/// Slots and where the value of each goes.
class SlotPairs {
 public:
  struct Pair {
    SlotRun from, to;
  };
  explicit SlotPairs(Device device = Device::cpu) : list_(device) {}

  /// Returns whether they have joined the last pair of runs.
  bool add(const SlotRun& from, const SlotRun& to, bool may_join = true) {
    std::pmr::vector<Pair>& all = list_.host();
    may_join &= !all.empty() && all.back().from.goes_on_with(from) && all.back().to.goes_on_with(to);
    if (may_join)
      all.back().from.length += from.length, all.back().to.length += to.length;
    else
      all.push_back({from, to});
    return may_join;
  }
  void clear() { list_.host().clear(); }
  const std::pmr::vector<Pair>& pairs() const { return list_.host(); }
  /// Call before values move, when pairs were added or cleared.
  void send() { list_.send(); }
  const Pair* device() const { return list_.device(); }

 private:
  Mirror<Pair> list_;
};

/// Slots in the order in which they were added, and their places in a message.
class SlotList {
 public:
  explicit SlotList(Device device = Device::cpu) : pairs_(device) {}
  void add(const SlotRun& run) {
    pairs_.add(run, {0, slots_, 1, run.length});
    slots_ += run.length;
  }
  void clear() { pairs_.clear(), slots_ = 0; }
  /// Pairs of a slot and its place in an array of them all.
  const SlotPairs& places() const { return pairs_; }
  void send() { pairs_.send(); }
  std::size_t slots() const { return slots_; }

 private:
  SlotPairs pairs_;
  std::uint32_t slots_ = 0;
};

}  // namespace silt::lbm
