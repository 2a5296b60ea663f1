#pragma once
// When do sweeps end? Pairs that no longer change are not solved again, so a cluster of bodies in contact (an
// island) comes to rest by itself, wherever it lies, and further sweeps change no bit of it. Only how many
// there are has to be agreed on, by ranks that contacts connect: each counts the sweeps for which it, and as
// far as it has heard the others, had nothing to solve again. The count of a rank is one more than the least
// of the counts it hears, 0 while it has something to do; above the number of messages that a word needs to
// come to all of them, all have been at rest in one and the same sweep, and each knows it in the same sweep
// (B. Szymanski, Y. Shi, N. Prywes, "Synchronized distributed termination", IEEE Trans. Softw. Eng. SE-11
// (1985) 1136). Ranks without a common contact do not wait for each other.
#include <span>

#include "rigid/bodies/body_exchange.hpp"

namespace silt::rigid {

class CommonRest {
 public:
  explicit CommonRest(BodyExchange& exchange) : exchange_(exchange) {}

  /// Whether the next sweep can find anything to solve on this rank, by what it has heard.
  bool idle() const { return quiet_ > 0; }
  /// Ends a sweep after which this rank has something to solve again (`moving`) or not. True in the same
  /// sweep on all ranks that contacts connect, once none of them has.
  bool reached(bool moving) {
    quiet_ = moving ? 0 : quiet_ + 1;
    return quiet_ > 0 && exchange_.cluster().all_have_heard(quiet_ - 1);
  }
  /// Shares the bodies' rows, if any of them may have changed since the last time, and what is known of rest.
  void share(BodySet& bodies, std::span<double> rows, int width) {
    quiet_ = exchange_.share_in_round(bodies, rows, width, quiet_, quiet_ < 2);
  }

 private:
  BodyExchange& exchange_;
  int quiet_ = 0;  // sweeps
};

/// Whether it is so on this rank or on any that contacts connect it with.
inline bool on_any(BodySet& bodies, BodyExchange& exchange, bool here) {
  int nowhere = !here;
  for (int rounds = 0; !exchange.cluster().all_have_heard(rounds); ++rounds)
    nowhere = exchange.share_in_round(bodies, {}, 0, nowhere, false);
  return nowhere == 0;
}

}  // namespace silt::rigid
