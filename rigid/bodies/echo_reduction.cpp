#include "rigid/bodies/echo_reduction.hpp"

#include <algorithm>

namespace silt::rigid {

void EchoReduction::begin(int rank, std::vector<int> partners, int all) {
  *this = {};
  rank_ = leader_ = parent_ = rank;
  all_ = all;
  partners_ = std::move(partners);
}

EchoReduction::Message EchoReduction::message(int value) const {
  return {value, leader_, distance_, parent_, depth_, ranks_, across_, known_from_};
}

int EchoReduction::receive(int value, std::span<const Message> messages) {
  ++round_;
  for (const Message& message : messages) value = std::min(value, message.value);
  if (across_ > 0) return value;
  follow(messages);
  update_children(messages);
  return value;
}

/// Adopts the least leader received; the sender is the parent, of several the one of the lowest rank.
void EchoReduction::follow(std::span<const Message> messages) {
  for (std::size_t k = 0; k < messages.size(); ++k)
    if (messages[k].leader < leader_) {
      leader_ = messages[k].leader;
      distance_ = messages[k].distance + 1;
      parent_ = partners_[k];
    }
}

void EchoReduction::update_children(std::span<const Message> messages) {
  depth_ = distance_;
  ranks_ = 1;
  bool whole = true;
  for (const Message& message : messages) {
    whole = whole && message.leader == leader_;
    if (message.leader != leader_) continue;
    if (message.across > 0) across_ = message.across, known_from_ = message.known_from;
    if (message.parent != rank_) continue;
    whole = whole && message.depth >= 0;
    depth_ = std::max(depth_, message.depth);
    ranks_ += message.ranks;
  }
  if (!whole) depth_ = -1;
  if (!whole || leader_ != rank_ || is_alone()) return;
  across_ = std::min(2 * depth_, ranks_ - 1);
  known_from_ = round_ + depth_;
}

/// The diameter of a cluster is less than the number of ranks, which all of them know from the start.
bool EchoReduction::is_complete(int rounds) const {
  if (is_alone() || rounds >= all_ - 1) return true;
  return across_ > 0 && round_ >= known_from_ && rounds >= across_;
}

}  // namespace silt::rigid
