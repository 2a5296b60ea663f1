#include "rigid/bodies/body_exchange.hpp"

#include <algorithm>
#include <cmath>

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

void Extent::wrap(Vec3& x, std::array<std::int32_t, 3>& image) const {
  for (int d = 0; d < 3; ++d) {
    if (!periodic[d] || (x[d] >= 0 && x[d] < size[d])) continue;
    const double periods = std::floor(x[d] / size[d]);
    x[d] -= periods * size[d];
    const double now = image[d] + periods;  // of a body that flies away it is only some large number
    image[d] = std::abs(now) <= 0x1p30 ? static_cast<std::int32_t>(now) : 1 << 30;
    if (x[d] < 0) x[d] = 0;  // rounding of the line above
    if (x[d] >= size[d]) {   // a tiny negative x, rounded up to the period itself
      x[d] = 0;
      ++image[d];
    }
  }
}

void BodyExchange::wrap_positions(BodySet& bodies) const {
  for (std::size_t row = 0; row < bodies.owned + bodies.copies; ++row)
    extent_.wrap(bodies.position[row], bodies.image[row]);
}

void BodyExchange::exchange_contacts(BodySet&, std::vector<Contact>&) {}

int BodyExchange::share_in_round(BodySet& bodies, std::span<double> rows, int width, int value,
                                 bool changed) {
  const RankCluster::Word said = cluster_.say(value);
  heard_.resize(cluster_.partners().size());
  share(bodies, rows, width, {&said, 1}, heard_, changed);
  return cluster_.hear(value, heard_);
}

}  // namespace silt::rigid
