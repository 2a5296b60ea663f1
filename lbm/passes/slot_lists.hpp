#pragma once
// Lists of slots in runs, and pairs of slots between which values are copied. The arrays are given at the
// copy, so that one list serves all arrays of the same layout.
#include <cstddef>
#include <cstdint>
#include <memory_resource>

#include "cpu/device_code.hpp"
#include "device/mirror.hpp"

namespace silt::lbm {

/// Slots first, first + stride, ... of an array.
struct SlotRun {
  std::uint32_t array, first;
  std::int32_t stride = 1;
  std::uint32_t length = 1;

  /// Returns whether `next` continues this run with the same stride.
  bool goes_on_with(const SlotRun& next) const {
    return array == next.array && stride == next.stride &&
           first + std::int64_t{stride} * length == std::int64_t{next.first};
  }
};

/// The arrays that values are copied from or to: a table of arrays, or one array for all.
template <class T>
struct SlotArrays {
  T* const* table = nullptr;
  T* only = nullptr;
  SILT_DEVICE T* operator[](std::uint32_t array) const { return table ? table[array] : only; }
};

/// Pairs of runs of slots, source and target.
class SlotPairs {
 public:
  struct Pair {
    SlotRun from, to;
  };
  explicit SlotPairs(Device device = Device::cpu) : list_(device) {}

  /// Adds a pair of runs; returns whether it was joined to the last pair.
  bool add(const SlotRun& from, const SlotRun& to, bool may_join = true) {
    is_sent_ = false;
    std::pmr::vector<Pair>& all = list_.host();
    may_join &= !all.empty() && all.back().from.goes_on_with(from) && all.back().to.goes_on_with(to);
    if (may_join)
      all.back().from.length += from.length, all.back().to.length += to.length;
    else
      all.push_back({from, to});
    return may_join;
  }
  void clear() { list_.host().clear(), is_sent_ = false; }
  const std::pmr::vector<Pair>& pairs() const { return list_.host(); }
  /// Copies the list to the device if it has changed. Call before values are copied.
  void send() {
    if (!is_sent_) list_.send();
    is_sent_ = true;
  }
  const Pair* device() const { return list_.device(); }

 private:
  Mirror<Pair> list_;
  bool is_sent_ = false;
};

/// Runs of slots in the order in which they were added, which is their order in a message.
class SlotList {
 public:
  explicit SlotList(Device device = Device::cpu) : pairs_(device) {}
  void add(const SlotRun& run) {
    pairs_.add(run, {0, slots_, 1, run.length});
    slots_ += run.length;
  }
  void clear() { pairs_.clear(), slots_ = 0; }
  /// Returns pairs of a slot and its place in the message.
  const SlotPairs& places() const { return pairs_; }
  void send() { pairs_.send(); }
  std::size_t slots() const { return slots_; }

 private:
  SlotPairs pairs_;
  std::uint32_t slots_ = 0;
};

}  // namespace silt::lbm
