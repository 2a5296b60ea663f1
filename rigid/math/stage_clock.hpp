#pragma once
// Wall-clock time by the stages of a step, and what of it went by in waiting for other ranks.
#include <array>
#include <chrono>
#include <functional>
#include <utility>

namespace silt::rigid {

/// Counts the seconds that this rank spends in each stage. `Stage` is an enum class whose last enumerator is
/// `count`. A stage that runs within another one suspends it, so no second is counted twice.
template <class Stage>
class StageClock {
 public:
  using Seconds = std::array<double, std::size_t(Stage::count)>;

  /// `waited` tells the seconds that this rank has waited for others since the program began; empty: never.
  explicit StageClock(std::function<double()> waited = {}) : waited_(std::move(waited)) {}

  /// Runs `work` as a part of `stage`, and returns what it returns. An exception ends the stage too.
  template <class Work>
  decltype(auto) timed(Stage stage, Work&& work) {
    const Turn turn(*this, stage);
    return std::forward<Work>(work)();
  }
  /// Of all stages that have ended, since the clock was made; waits are a part of them.
  const Seconds& seconds() const { return seconds_; }
  const Seconds& waits() const { return waits_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Makes a stage the running one for as long as it lives.
  class Turn {
   public:
    Turn(StageClock& clock, Stage stage) : clock_(clock), outer_(clock.change_to(stage)) {}
    ~Turn() { clock_.change_to(outer_); }
    Turn(const Turn&) = delete;

   private:
    StageClock& clock_;
    Stage outer_;
  };

  /// Charges the time since the last change to the stage that ran, and returns that stage.
  Stage change_to(Stage next) {
    const Clock::time_point now = Clock::now();
    const double waited = waited_ ? waited_() : 0;
    if (running_ != Stage::count) {
      seconds_[std::size_t(running_)] += std::chrono::duration<double>(now - changed_).count();
      waits_[std::size_t(running_)] += waited - waited_at_change_;
    }
    changed_ = now;
    waited_at_change_ = waited;
    return std::exchange(running_, next);
  }

  std::function<double()> waited_;
  Stage running_ = Stage::count;  // count: none
  Clock::time_point changed_;
  double waited_at_change_ = 0;
  Seconds seconds_{}, waits_{};
};

}  // namespace silt::rigid
