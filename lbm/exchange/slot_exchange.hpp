#pragma once
// Copies values from slots of arrays to slots of others, on one rank or between ranks: ghost layers, pairs of
// links, moments of neighbours etc. Both ends of a message must list its slots in one order.
#include <map>
#include <memory_resource>
#include <span>
#include <vector>

#include "device/device.hpp"
#include "lbm/passes/slot_lists.hpp"
#include "parallel/messages.hpp"

namespace silt::lbm {

template <class T>
class SlotExchange {
 public:
  /// All messages use this communicator and tag. For a device that packs and moves the values, the values and
  /// the pointers to the arrays must be in memory that the device reaches (Mirror::device).
  SlotExchange(MPI_Comm comm, int tag, Device device = Device::cpu)
      : device_(device), copied_(device), transfers_(comm, tag) {}

  /// The lists of slots to copy on this rank, to send, and to receive. In an exchange backwards the received
  /// slots are sent and the sent slots received.
  SlotPairs& copied() { return is_sent_ = false, copied_; }
  SlotList& sent(int rank) { return peer(rank).list[0]; }
  SlotList& received(int rank) { return peer(rank).list[1]; }
  /// Lists a run that is copied from one rank to another, one of which is `here`.
  void add(int from_rank, const SlotRun& from, int to_rank, const SlotRun& to, int here) {
    if (from_rank == to_rank)
      copied().add(from, to);
    else if (from_rank == here)
      sent(to_rank).add(from);
    else
      received(from_rank).add(to);
  }
  /// Lets finish() send the message to this rank, since its slots are not written before start().
  void hold_back(int rank) { peer(rank).early = false; }
  void clear();
  /// Copies changed lists to the device; start() does so if this was not called.
  void send_lists();

  /// Posts the receives and sends the values of these arrays that need not be held back.
  void start(std::span<const T* const> sources, bool back = false);
  /// Lets messages under way progress.
  void progress() { transfers_.progress(); }
  /// Completes the exchange. Values for a target that is a null pointer are dropped.
  void finish(std::span<const T* const> sources, std::span<T* const> targets, bool back = false);

  /// Returns the bytes that this rank sends in one exchange, or only those sent by start().
  std::size_t message_bytes(bool early_alone = false) const;

 private:
  struct Peer {
    bool early = true;
    SlotList list[2];               // sent, received
    std::pmr::vector<T> buffer[2];  // one per list
    explicit Peer(Device device)
        : list{SlotList(device), SlotList(device)},
          buffer{std::pmr::vector<T>(message_memory(device)), std::pmr::vector<T>(message_memory(device))} {}
  };

  Peer& peer(int rank) { return is_sent_ = false, peers_.try_emplace(rank, device_).first->second; }
  void send(std::span<const T* const> sources, bool back, bool early);

  Device device_;
  bool is_sent_ = false;  // the device has the present lists
  SlotPairs copied_;
  std::map<int, Peer> peers_;  // by rank
  parallel::Transfers transfers_;
};

}  // namespace silt::lbm
