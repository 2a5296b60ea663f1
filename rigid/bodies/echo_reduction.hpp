#pragma once
#include <span>
#include <vector>

namespace silt::rigid {

/// Computes the minimum of a value over the ranks that contacts connect directly or indirectly (a cluster),
/// without messages to other ranks. Messages go between ranks with a common contact, in rounds of the whole
/// cluster. A value reaches all ranks after a number of rounds, the cluster's diameter.
///
/// It is the echo algorithm with extinction (E. Chang, "Echo algorithms: depth parallel operations on general
/// graphs", IEEE Trans. Softw. Eng. SE-8 (1982) 391). The lowest rank of the cluster is its leader. Every
/// rank adopts the lowest leader received, and as its parent the rank that sent it first. A rank is whole if
/// its partners have the same leader and all its children are whole: the subtree below it is complete. A
/// leader that is not the lowest rank never becomes whole, since some rank of its tree has a partner that
/// never followed it. The whole leader knows the depth of its tree and the number of ranks: the diameter is
/// at most twice the depth and less than that number. It sends this bound and the round from which all know
/// it.
class EchoReduction {
 public:
  /// The message of a rank to its partners in a round.
  struct Message {
    int value;  // to be reduced
    int leader, distance, parent;
    int depth, ranks;        // of the subtree below the rank; depth -1: not whole yet
    int across, known_from;  // bound of the diameter and the round from which all know it; 0: unknown
  };

  /// Starts with the ranks that own contact partners of bodies owned here; `all`: number of ranks.
  void begin(int rank, std::vector<int> partners, int all);
  const std::vector<int>& partners() const { return partners_; }
  bool is_alone() const { return partners_.empty(); }

  /// Returns this rank's message in a round.
  Message message(int value) const;
  /// Ends a round with the messages of all partners, in their order. Returns the least value.
  int receive(int value, std::span<const Message> messages);
  /// Returns whether the values of `rounds` rounds ago have reached all ranks of the cluster and all know it.
  /// The answer is the same on all of them in each round; without partners it is true for 0 rounds.
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
