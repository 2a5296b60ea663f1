#include "rigid/bodies/rank_cluster.hpp"

#include <algorithm>

namespace silt::rigid {

void RankCluster::begin(int rank, std::vector<int> partners, int all) {
  *this = {};
  rank_ = leader_ = parent_ = rank;
  all_ = all;
  partners_ = std::move(partners);
}

RankCluster::Word RankCluster::say(int value) const {
  return {value, leader_, distance_, parent_, depth_, ranks_, across_, known_from_};
}

int RankCluster::hear(int value, std::span<const Word> words) {
  ++round_;
  for (const Word& word : words) value = std::min(value, word.value);
  if (across_ > 0) return value;
  follow(words);
  look_at_children(words);
  return value;
}

/// The least number heard of leads; who said so first, the one of them with the lowest number, is the parent.
void RankCluster::follow(std::span<const Word> words) {
  for (std::size_t k = 0; k < words.size(); ++k)
    if (words[k].leader < leader_) {
      leader_ = words[k].leader;
      distance_ = words[k].distance + 1;
      parent_ = partners_[k];
    }
}

void RankCluster::look_at_children(std::span<const Word> words) {
  depth_ = distance_;
  ranks_ = 1;
  bool whole = true;
  for (const Word& word : words) {
    whole = whole && word.leader == leader_;
    if (word.leader != leader_) continue;
    if (word.across > 0) across_ = word.across, known_from_ = word.known_from;
    if (word.parent != rank_) continue;
    whole = whole && word.depth >= 0;
    depth_ = std::max(depth_, word.depth);
    ranks_ += word.ranks;
  }
  if (!whole) depth_ = -1;
  if (!whole || leader_ != rank_ || is_alone()) return;
  across_ = std::min(2 * depth_, ranks_ - 1);
  known_from_ = round_ + depth_;
}

/// No cluster is as far across as there are ranks, which all know from the start.
bool RankCluster::all_have_heard(int rounds) const {
  if (is_alone() || rounds >= all_ - 1) return true;
  return across_ > 0 && round_ >= known_from_ && rounds >= across_;
}

}  // namespace silt::rigid
