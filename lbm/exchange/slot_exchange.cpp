#include "lbm/exchange/slot_exchange.hpp"

#include "lbm/passes/passes.hpp"

namespace silt::lbm {

template <class T>
void SlotExchange<T>::clear() {
  is_sent_ = false;
  copied_.clear();
  for (auto& [rank, peer] : peers_)
    for (SlotList& list : peer.list) list.clear();
}

template <class T>
void SlotExchange<T>::send(std::span<const T* const> sources, bool back, bool early) {
  const Passes<T>& passes = passes_on<T>(device_);
  const auto is_sent = [&](const Peer& peer) { return peer.early == early && peer.list[back].slots() > 0; };
  for (auto& [rank, peer] : peers_) {
    if (!is_sent(peer)) continue;
    peer.buffer[back].resize(peer.list[back].slots());
    passes.move_slots(peer.list[back].places(), {}, {.table = sources.data()},
                      {.only = peer.buffer[back].data()}, false);
  }
  passes.wait();
  for (auto& [rank, peer] : peers_) {
    if (!is_sent(peer)) continue;
    transfers_.send(rank, std::span(peer.buffer[back]));
    from_device(peer.buffer[back]);
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
  const Passes<T>& passes = passes_on<T>(device_);
  send(sources, back, false);
  passes.move_slots(copied_, {}, {.table = sources.data()}, {.table = targets.data()}, back);
  transfers_.wait();
  for (auto& [rank, peer] : peers_) {
    passes.move_slots(peer.list[!back].places(), {}, {.only = peer.buffer[!back].data()},
                      {.table = targets.data()}, true);
    to_device(peer.buffer[!back]);
  }
  passes.wait();
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
