#pragma once
// Wall-clock time by the stages of a step, and what else is counted by stage.
#include <array>
#include <chrono>
#include <functional>
#include <utility>

namespace silt::rigid {

/// Counts the seconds that this rank spends in each stage. `Stage` is an enum class whose last enumerator is
/// `count`. A stage that runs within another one suspends it, so no second is counted twice. A Reading is
/// what some meter shows, a number or a set of them; it begins at zero and can be added and subtracted.
template <class Stage, class Reading = double>
class StageClock {
 public:
  using Seconds = std::array<double, std::size_t(Stage::count)>;
  using Readings = std::array<Reading, std::size_t(Stage::count)>;

  /// `read` reads a meter that never goes back; empty: there is none.
  explicit StageClock(std::function<Reading()> read = {}) : read_(std::move(read)) {}

  /// Stages one after the other: the first runs until goes_on, the last as long as this lives.
  class Turn {
   public:
    Turn(StageClock& clock, Stage first) : clock_(clock), outer_(clock.change_to(first)) {}
    ~Turn() { clock_.change_to(outer_); }
    Turn(const Turn&) = delete;
    void goes_on(Stage next) { clock_.change_to(next); }

   private:
    StageClock& clock_;
    Stage outer_;
  };

  /// Runs `work` as a part of `stage`, and returns what it returns. An exception ends the stage too.
  template <class Work>
  decltype(auto) timed(Stage stage, Work&& work) {
    const Turn turn(*this, stage);
    return std::forward<Work>(work)();
  }
  /// Return the sums over all stages that have ended since the clock was made.
  const Seconds& seconds() const { return seconds_; }
  const Readings& readings() const { return readings_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Charges the time since the last change to the stage that ran, and returns that stage.
  Stage change_to(Stage next) {
    const Clock::time_point now = Clock::now();
    const Reading reading = read_ ? read_() : Reading{};
    if (running_ != Stage::count) {
      seconds_[std::size_t(running_)] += std::chrono::duration<double>(now - changed_).count();
      readings_[std::size_t(running_)] += reading - at_change_;
    }
    changed_ = now;
    at_change_ = reading;
    return std::exchange(running_, next);
  }

  std::function<Reading()> read_;
  Stage running_ = Stage::count;  // count: none
  Clock::time_point changed_;
  Reading at_change_{};
  Seconds seconds_{};
  Readings readings_{};
};

}  // namespace silt::rigid
