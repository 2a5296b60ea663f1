#pragma once
// Copies values from slots of arrays to slots of others, on one rank or between ranks: ghost layers, pairs of
// links, moments of neighbours etc. Both ends of a message must list its slots in one order.
//
// Where the devices of two ranks can read one another's memory (device/exported_memory.hpp), one packs values
// into its own memory and sends their place, and the other takes them from there. Each of two ranks packs
// into two buffers in turn: when it packs into one again it has the other's next message, before which that
// rank had taken the values. So places go both ways, even if values go one way.
#include <algorithm>
#include <map>
#include <memory_resource>
#include <span>
#include <utility>
#include <vector>

#include "device/device.hpp"
#include "device/exported_memory.hpp"
#include "lbm/passes/slot_lists.hpp"
#include "parallel/communicator.hpp"
#include "parallel/messages.hpp"

namespace silt::lbm {

/// Returns the ranks of this machine whose device and that of this rank can read one another's memory; none
/// for `cpu`. Collective.
std::vector<int> ranks_that_share(MPI_Comm, Device);

template <class T>
class SlotExchange {
 public:
  /// All messages use this communicator and tag. For a device that packs and moves the values, the values and
  /// the pointers to the arrays must be in memory that the device reaches (Mirror::device); the constructor
  /// is then collective, and the ranks must meet between the last exchange and the destructor. `sharing`: the
  /// ranks whose device shares memory with this one's (ranks_that_share).
  SlotExchange(MPI_Comm comm, int tag, Device device = Device::cpu)
      : SlotExchange(comm, tag, device, ranks_that_share(comm, device)) {}
  SlotExchange(MPI_Comm comm, int tag, Device device, std::vector<int> sharing)
      : device_(device),
        here_(parallel::rank_of(comm)),
        sharing_(std::move(sharing)),
        copied_(device),
        transfers_(comm, tag) {}

  /// The lists of slots to copy on this rank, to send, and to receive. In an exchange backwards the received
  /// slots are sent and the sent slots received.
  SlotPairs& copied() { return copied_; }
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
  /// Returns whether values to or from a rank, maybe this one, go from device to device, past the processors.
  bool is_direct(int rank) const;
  /// Clears the lists, or only those of values that are not direct.
  void clear(bool keep_direct = false);
  /// Copies changed lists to the device; start() does so if this was not called.
  void send_lists();

  /// Posts the receives and sends the values of these arrays that need not be held back.
  void start(std::span<const T* const> sources, bool back = false);
  /// Lets messages under way progress.
  void progress() { transfers_.progress(); }
  /// Completes the exchange. Values for a target that is a null pointer are dropped.
  void finish(std::span<const T* const> sources, std::span<T* const> targets, bool back = false);

  /// Returns the bytes of the values that this rank sends in one exchange, or only those sent by start().
  std::size_t message_bytes(bool early_alone = false) const;

 private:
  struct Peer {
    bool early = true, shares;
    SlotList list[2];               // sent, received
    std::pmr::vector<T> buffer[2];  // one per list, of a rank that does not share
    DeviceArray<T> packed[2];       // of one that does, in turn
    int turn = 0;
    ExportedPlace sent, received;

    Peer(Device device, bool shares)
        : shares(shares),
          list{SlotList(device), SlotList(device)},
          buffer{std::pmr::vector<T>(message_memory(device)), std::pmr::vector<T>(message_memory(device))},
          packed{DeviceArray<T>(exported_memory(device)), DeviceArray<T>(exported_memory(device))} {}
    bool has_message(int of_list) const {
      return list[of_list].slots() > 0 || (shares && list[!of_list].slots() > 0);
    }
    T* room_to_pack(Device, std::size_t slots);
  };

  Peer& peer(int rank) {
    return peers_.try_emplace(rank, device_, std::ranges::count(sharing_, rank) > 0).first->second;
  }
  void send(std::span<const T* const> sources, bool back, bool early);

  Device device_;
  int here_;                  // this rank
  std::vector<int> sharing_;  // ranks
  SlotPairs copied_;
  std::map<int, Peer> peers_;  // by rank
  parallel::Transfers transfers_;
};

}  // namespace silt::lbm
