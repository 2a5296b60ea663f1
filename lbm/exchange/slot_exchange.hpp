#pragma once
// Values go from slots of arrays to slots of others, on this rank or another: ghost layers, pairs of links,
// the cells of another cut, moments of neighbours. Both ends of a message must list its slots in one order.
#include <map>
#include <memory_resource>
#include <span>
#include <vector>

#include "device/device.hpp"
#include "lbm/passes/slot_lists.hpp"
#include "parallel/transfers.hpp"

namespace silt::lbm {

template <class T>
class SlotExchange {
 public:
  /// All messages go by this communicator and tag. Where values are packed and moved by a device, they and
  /// the pointers to arrays lie where it finds them (Mirror::there).
  SlotExchange(MPI_Comm comm, int tag, Device device = Device::cpu)
      : device_(device), copied_(device), transfers_(comm, tag) {}

  /// The lists: what goes from slot to slot on this rank, and what this one sends another and receives from
  /// it. An exchange may also go back: then received slots are sent, and sent ones received.
  SlotPairs& copied() { return is_sent_ = false, copied_; }
  SlotList& sent(int rank) { return peer(rank).list[0]; }
  SlotList& received(int rank) { return peer(rank).list[1]; }
  /// Lists a run that goes from a rank to a rank, one of which is `here`.
  void add(int from_rank, const SlotRun& from, int to_rank, const SlotRun& to, int here) {
    if (from_rank == to_rank)
      copied().add(from, to);
    else if (from_rank == here)
      sent(to_rank).add(from);
    else
      received(from_rank).add(to);
  }
  /// The slots for that rank are not there yet at start(): finish() sends them.
  void hold_back(int rank) { peer(rank).early = false; }
  void clear();
  /// Gives the device the lists if they have changed; start() does so at the latest.
  void send_lists();

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
    SlotList list[2];               // sent, received
    std::pmr::vector<T> buffer[2];  // of the lists
    explicit Peer(Device device)
        : list{SlotList(device), SlotList(device)},
          buffer{std::pmr::vector<T>(message_memory(device)), std::pmr::vector<T>(message_memory(device))} {}
  };

  Peer& peer(int rank) { return is_sent_ = false, peers_.try_emplace(rank, device_).first->second; }
  void send(std::span<const T* const> sources, bool back, bool early);

  Device device_;
  bool is_sent_ = false;  // a device has the lists as they are
  SlotPairs copied_;
  std::map<int, Peer> peers_;  // by rank
  parallel::Transfers transfers_;
};

}  // namespace silt::lbm
