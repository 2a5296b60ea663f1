#pragma once
// Wall-clock time, and optionally another meter, by the stages of a step.
#include <array>
#include <chrono>
#include <functional>
#include <utility>

namespace silt::rigid {

/// Measures the seconds that this rank spends in each stage. `Stage` is an enum class whose last enumerator
/// is `count`. A stage nested in another suspends it, so no second is counted twice. A Reading is the state
/// of a meter: zero by default, with += and -.
template <class Stage, class Reading = double>
class StageClock {
 public:
  using Seconds = std::array<double, std::size_t(Stage::count)>;
  using Readings = std::array<Reading, std::size_t(Stage::count)>;

  /// `read` reads a meter that never decreases; without it no readings are taken.
  explicit StageClock(std::function<Reading()> read = {}) : read_(std::move(read)) {}

  /// Runs consecutive stages: the first until switch_to, the last until destruction.
  class Scope {
   public:
    Scope(StageClock& clock, Stage first) : clock_(clock), outer_(clock.change_to(first)) {}
    ~Scope() { clock_.change_to(outer_); }
    Scope(const Scope&) = delete;
    void switch_to(Stage next) { clock_.change_to(next); }

   private:
    StageClock& clock_;
    Stage outer_;
  };

  /// Runs `work` as part of `stage` and returns its result. The stage ends at an exception, too.
  template <class Work>
  decltype(auto) timed(Stage stage, Work&& work) {
    const Scope scope(*this, stage);
    return std::forward<Work>(work)();
  }
  /// Return the sums over all stages that have ended since construction.
  const Seconds& seconds() const { return seconds_; }
  const Readings& readings() const { return readings_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Adds the time since the last change to the stage that ran, and returns that stage.
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
  Stage running_ = Stage::count;  // count: no stage
  Clock::time_point changed_;
  Reading at_change_{};
  Seconds seconds_{};
  Readings readings_{};
};

}  // namespace silt::rigid
