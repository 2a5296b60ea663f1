#pragma once
#include <span>
#include <vector>

namespace silt::rigid {

/// The least of a value over the ranks that contacts connect, directly or over others (a cluster), without a
/// message to or from any other rank. Messages go between ranks with a common contact, in rounds in which the
/// whole cluster takes part. A value reaches all of them after as many rounds as the cluster is across; the
/// first rounds find that number with the same messages.
///
/// It is the echo algorithm with extinction of waves (E. Chang, "Echo algorithms: depth parallel operations
/// on general graphs", IEEE Trans. Softw. Eng. SE-8 (1982) 391). The rank of the lowest number in the cluster
/// leads it. Every rank takes the lowest number that has reached it for its leader and the rank that sent it
/// first for its parent. A rank is whole if its partners all have its leader and all of its children are
/// whole: the part of the tree below it is complete. A leader that is not the lowest never becomes whole,
/// since next to some rank on its tree there is one that never followed it. The leader that is whole knows
/// the depth of its tree and the number of ranks: the cluster is at most twice the depth across, and less
/// than the number. It sends all of them this, and from which round on all know.
class EchoReduction {
 public:
  /// What a rank sends its partners in a round.
  struct Message {
    int value;  // to be reduced
    int leader, distance, parent;
    int depth, ranks;        // of the part of the tree below the rank; depth -1: not whole yet
    int across, known_from;  // what the leader found; 0: nothing yet
  };

  /// Begins with the ranks that own a partner of a body owned here. `all` is the number of ranks there are.
  void begin(int rank, std::vector<int> partners, int all);
  const std::vector<int>& partners() const { return partners_; }
  bool is_alone() const { return partners_.empty(); }

  /// Returns what this rank sends in a round.
  Message message(int value) const;
  /// Ends a round with the messages of the partners, in their order. Returns the least of their values and
  /// this rank's.
  int receive(int value, std::span<const Message> messages);
  /// Returns whether the values of `rounds` rounds ago have reached all ranks of the cluster, and all of them
  /// know that. All ranks get one answer in a round; it is true for 0 rounds on a rank alone.
  bool is_complete(int rounds) const;

 private:
  void follow(std::span<const Message> messages);
  void update_children(std::span<const Message> messages);

  int rank_ = 0, all_ = 1;
  std::vector<int> partners_;
  int round_ = 0;
  int leader_ = 0, distance_ = 0, parent_ = 0;
  int depth_ = -1, ranks_ = 1;
  int across_ = 0, known_from_ = 0;
};

}  // namespace silt::rigid
