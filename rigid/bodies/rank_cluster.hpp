#pragma once
// The ranks that contacts connect, directly or over others: how they agree on something without a message to
// or from anybody else. Words go between ranks with a common contact, in rounds that all of the cluster take
// part in. What one rank says, all have heard after as many rounds as the cluster is across; how many that
// are is found in the first rounds, with the same messages.
//
// The rank of the lowest number in the cluster leads it. Every rank takes the lowest number it has heard of
// for its leader and the one who said it first for its parent. One whose partners all have the same leader,
// and all of whose children are whole, is whole: the part of the tree that hangs on it is complete. A leader
// that is not the lowest never becomes whole, since next to somebody on its tree there is one who never
// followed it (E. Chang, "Echo algorithms: depth parallel operations on general graphs", IEEE Trans. Softw.
// Eng. SE-8 (1982) 391; with extinction of waves). The leader that is whole knows the depth of its tree and
// the number of ranks: the cluster is at most twice the depth across, and less than the number. It tells all,
// and from which round on all know.
#include <array>
#include <span>
#include <vector>

namespace silt::rigid {

class RankCluster {
 public:
  /// What a rank tells its partners in a round.
  struct Word {
    int value;  // of what is to be agreed on
    int leader, distance, parent;
    int depth, ranks;        // of the part of the tree from here on; depth -1: not whole yet
    int across, known_from;  // what the leader found; 0: nothing yet
  };

  /// Begins with the ranks that own a partner of a body owned here. `all` is the number of ranks there are.
  void begin(int rank, std::vector<int> partners, int all);
  const std::vector<int>& partners() const { return partners_; }
  bool is_alone() const { return partners_.empty(); }

  Word say(int value) const;
  /// Ends a round with what the partners said, in their order. Returns the least of their values and this
  /// rank's.
  int hear(int value, std::span<const Word> words);
  /// Whether what was said `rounds` rounds ago has come to all of the cluster, and all of it know that. The
  /// same on all of them in any round; true for 0 rounds on a rank alone.
  bool all_have_heard(int rounds) const;

 private:
  void follow(std::span<const Word> words);
  void look_at_children(std::span<const Word> words);

  int rank_ = 0, all_ = 1;
  std::vector<int> partners_;
  int round_ = 0;
  int leader_ = 0, distance_ = 0, parent_ = 0;
  int depth_ = -1, ranks_ = 1;
  int across_ = 0, known_from_ = 0;
};

}  // namespace silt::rigid
