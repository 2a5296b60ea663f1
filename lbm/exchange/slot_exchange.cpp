#include "lbm/exchange/slot_exchange.hpp"

#include <algorithm>
#include <ranges>
#include <stdexcept>
#include <string>

#include "lbm/passes/passes.hpp"
#include "parallel/collectives.hpp"
#include "parallel/communicator.hpp"

namespace silt::lbm {

template <class T>
bool SlotExchange<T>::is_direct(int rank) const {
  return device_ != Device::cpu && (rank == here_ || std::ranges::count(sharing_, rank) > 0);
}

template <class T>
void SlotExchange<T>::clear(bool keep_direct) {
  const auto keeps = [&](int rank) { return keep_direct && is_direct(rank); };
  if (!keeps(here_)) copied_.clear();
  for (auto& [rank, peer] : peers_)
    if (!keeps(rank))
      for (SlotList& list : peer.list) list.clear();
}

/// Returns where to pack values that the other rank's device takes from there.
template <class T>
T* SlotExchange<T>::Peer::room_to_pack(Device device, std::size_t slots) {
  DeviceArray<T>& to = packed[turn ^= 1];
  if (to.size() < slots || to.empty()) to = DeviceArray<T>(slots + slots / 2 + 1, to.get_allocator());
  sent = place_of(device, to.data());
  return to.data();
}

template <class T>
void SlotExchange<T>::send(std::span<const T* const> sources, bool back, bool early) {
  const Passes<T>& passes = passes_on<T>(device_);
  const auto is_sent = [&](const auto& of) {
    return of.second.early == early && of.second.has_message(back);
  };
  if (std::ranges::none_of(peers_, is_sent)) return;
  for (auto& [rank, peer] : peers_ | std::views::filter(is_sent)) {
    const std::size_t slots = peer.list[back].slots();
    if (!peer.shares) peer.buffer[back].resize(slots);
    T* const packed = peer.shares ? peer.room_to_pack(device_, slots) : peer.buffer[back].data();
    passes.move_slots(peer.list[back].places(), {}, {.table = sources.data()}, {.only = packed}, false);
  }
  passes.wait();
  for (auto& [rank, peer] : peers_ | std::views::filter(is_sent)) {
    if (peer.shares) {
      transfers_.send(rank, std::span(&peer.sent, 1));
    } else {
      transfers_.send(rank, std::span(peer.buffer[back]));
      from_device(peer.buffer[back]);
    }
  }
}

template <class T>
void SlotExchange<T>::start(std::span<const T* const> sources, bool back) {
  send_lists();
  for (auto& [rank, peer] : peers_) {
    if (!peer.has_message(!back)) continue;
    if (peer.shares) {
      transfers_.receive(rank, std::span(&peer.received, 1));
    } else {
      peer.buffer[!back].resize(peer.list[!back].slots());
      transfers_.receive(rank, std::span(peer.buffer[!back]));
    }
  }
  send(sources, back, true);
}

template <class T>
void SlotExchange<T>::finish(std::span<const T* const> sources, std::span<T* const> targets, bool back) {
  const Passes<T>& passes = passes_on<T>(device_);
  send(sources, back, false);
  passes.move_slots(copied_, {}, {.table = sources.data()}, {.table = targets.data()}, back);
  transfers_.wait();
  for (auto& [rank, peer] : peers_) {
    if (peer.list[!back].slots() == 0) continue;
    const T* const values =
        peer.shares ? static_cast<const T*>(opened(device_, peer.received)) : peer.buffer[!back].data();
    if (!values) throw std::runtime_error("memory of rank " + std::to_string(rank) + " cannot be opened");
    passes.move_slots(peer.list[!back].places(), {}, {.only = values}, {.table = targets.data()}, true);
    if (!peer.shares) to_device(peer.buffer[!back]);
  }
  passes.wait();
}

template <class T>
void SlotExchange<T>::send_lists() {
  copied_.send();
  for (auto& [rank, peer] : peers_)
    for (SlotList& list : peer.list) list.send();
}

template <class T>
std::size_t SlotExchange<T>::message_bytes(bool early_alone) const {
  std::size_t slots = 0;
  for (const auto& [rank, peer] : peers_)
    if (peer.early || !early_alone) slots += peer.list[0].slots();
  return slots * sizeof(T);
}

std::vector<int> ranks_that_share(MPI_Comm comm, Device device) {
  if (device == Device::cpu) return {};
  struct Offer {
    int rank;
    ExportedPlace place;
  };
  const DeviceArray<char> probe(1, exported_memory(device));
  const Offer mine{parallel::rank_of(comm), place_of(device, probe.data())};
  MPI_Comm machine;
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  const std::vector<Offer> offers =
      parallel::gathered(machine, std::span(&mine, 1), parallel::GatherTo::all_ranks);
  std::vector<int> reads;  // numbers among `offers`
  for (std::size_t k = 0; k < offers.size(); ++k)
    if (opened(device, offers[k].place)) reads.push_back(int(k));
  std::vector<std::size_t> first;
  const std::vector<int> all =
      parallel::gathered(machine, std::span<const int>(reads), parallel::GatherTo::all_ranks, &first);
  const int here = parallel::rank_of(machine);
  MPI_Comm_free(&machine);
  std::vector<int> share;
  for (const int k : reads)
    if (std::find(all.begin() + std::ptrdiff_t(first[k]), all.begin() + std::ptrdiff_t(first[k + 1]), here) !=
        all.begin() + std::ptrdiff_t(first[k + 1]))
      share.push_back(offers[k].rank);
  return share;
}

template class SlotExchange<float>;
template class SlotExchange<double>;

}  // namespace silt::lbm
