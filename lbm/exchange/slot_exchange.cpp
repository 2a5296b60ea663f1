#include "lbm/exchange/slot_exchange.hpp"

#include "lbm/passes/device_passes.hpp"

namespace silt::lbm {

template <class T>
void SlotExchange<T>::move(const SlotPairs& pairs, SlotArrays<const T> sources, SlotArrays<T> targets,
                           bool back) const {
  if (device_ != Device::cpu) return passes_on<T>(device_).move_slots(pairs, {}, sources, targets, back);
  pairs.move(sources, targets, back, [](std::size_t) { return [](T value) { return value; }; });
}

template <class T>
void SlotExchange<T>::clear() {
  is_sent_ = false;
  copied_.clear();
  for (auto& [rank, peer] : peers_)
    for (SlotList& list : peer.list) list.clear();
}

template <class T>
void SlotExchange<T>::send(std::span<const T* const> sources, bool back, bool early) {
  const auto is_sent = [&](const Peer& peer) { return peer.early == early && peer.list[back].slots() > 0; };
  for (auto& [rank, peer] : peers_) {
    if (!is_sent(peer)) continue;
    peer.buffer[back].resize(peer.list[back].slots());
    move(peer.list[back].places(), {.table = sources.data()}, {.only = peer.buffer[back].data()}, false);
  }
  wait(device_);
  for (auto& [rank, peer] : peers_) {
    if (!is_sent(peer)) continue;
    transfers_.send(rank, std::span(peer.buffer[back]));
    if (device_ != Device::cpu) from_device(peer.buffer[back]);
  }
}

template <class T>
void SlotExchange<T>::start(std::span<const T* const> sources, bool back) {
  send_lists();
  for (auto& [rank, peer] : peers_) {
    std::pmr::vector<T>& buffer = peer.buffer[!back];
    buffer.resize(peer.list[!back].slots());
    if (!buffer.empty()) transfers_.receive(rank, std::span(buffer));
  }
  send(sources, back, true);
}

template <class T>
void SlotExchange<T>::finish(std::span<const T* const> sources, std::span<T* const> targets, bool back) {
  send(sources, back, false);
  move(copied_, {.table = sources.data()}, {.table = targets.data()}, back);
  transfers_.wait();
  for (auto& [rank, peer] : peers_) {
    move(peer.list[!back].places(), {.only = peer.buffer[!back].data()}, {.table = targets.data()}, true);
    if (device_ != Device::cpu) to_device(peer.buffer[!back]);
  }
  wait(device_);
}

template <class T>
void SlotExchange<T>::send_lists() {
  if (is_sent_) return;
  is_sent_ = true;
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

template class SlotExchange<float>;
template class SlotExchange<double>;

}  // namespace silt::lbm
