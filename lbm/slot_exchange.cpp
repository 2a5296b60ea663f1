#include "lbm/slot_exchange.hpp"

namespace silt::lbm {

namespace {

/// Copies a few values at a time, without a call.
template <class T>
void pack(std::span<const T* const> sources, const SlotList& list, T* to) {
  for (const SlotRun& run : list.runs()) {
    const T* const from = sources[run.array] + run.first;
    if (run.stride == 1)
      for (std::uint32_t n = 0; n < run.length; ++n) to[n] = from[n];
    else
      for (std::ptrdiff_t n = 0; n < run.length; ++n) to[n] = from[n * run.stride];
    to += run.length;
  }
}

template <class T>
void unpack(const T* from, const SlotList& list, std::span<T* const> targets) {
  for (const SlotRun& run : list.runs()) {
    if (targets[run.array]) {
      T* const to = targets[run.array] + run.first;
      if (run.stride == 1)
        for (std::uint32_t n = 0; n < run.length; ++n) to[n] = from[n];
      else
        for (std::ptrdiff_t n = 0; n < run.length; ++n) to[n * run.stride] = from[n];
    }
    from += run.length;
  }
}

}  // namespace

template <class T>
void SlotExchange<T>::clear() {
  copied_.clear();
  for (auto& [rank, peer] : peers_)
    for (SlotList& list : peer.list) list.clear();
}

template <class T>
void SlotExchange<T>::send(std::span<const T* const> sources, bool back, bool early) {
  for (auto& [rank, peer] : peers_) {
    if (peer.early != early || peer.list[back].slots() == 0) continue;
    std::vector<T>& buffer = peer.buffer[back];
    buffer.resize(peer.list[back].slots());
    pack(sources, peer.list[back], buffer.data());
    transfers_.send(rank, std::span(buffer));
  }
}

template <class T>
void SlotExchange<T>::start(std::span<const T* const> sources, bool back) {
  for (auto& [rank, peer] : peers_) {
    std::vector<T>& buffer = peer.buffer[!back];
    buffer.resize(peer.list[!back].slots());
    if (!buffer.empty()) transfers_.receive(rank, std::span(buffer));
  }
  send(sources, back, true);
}

template <class T>
void SlotExchange<T>::finish(std::span<const T* const> sources, std::span<T* const> targets, bool back) {
  send(sources, back, false);
  copied_.move(sources, targets, back, [](T value) { return value; });
  transfers_.wait();
  for (auto& [rank, peer] : peers_) unpack(peer.buffer[!back].data(), peer.list[!back], targets);
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
