#pragma once
// Stops a run in good order on a signal or at a limit of wall-clock time.
#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <string>

#include "parallel/pending_sums.hpp"

namespace silt {

/// Makes SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2 and SIGXCPU set a flag, for the whole process; a second
/// signal at least one second later ends the process. Ignores SIGPIPE.
void catch_signals();

/// Asks all ranks at intervals whether one is to stop. The answer is read when the next question is due, so
/// that no step waits for it, or at once if a step takes longer than longest_overlapped.
class StopRequest {
 public:
  /// Sets a limit of limit_seconds of wall-clock time from now on; 0: none.
  StopRequest(MPI_Comm, double limit_seconds);
  /// Returns why all ranks stop now, or "". Call after every step. A signal takes effect after two questions,
  /// i.e. 2 * between_questions or two steps, for slow steps at most 2 * most_steps_between. Collective.
  std::string why(std::int64_t step);

 private:
  static constexpr double between_questions = 0.2, longest_overlapped = 1;  // seconds
  static constexpr std::int64_t most_steps_between = 16;
  void ask(std::int64_t step);
  void take_answer();

  MPI_Comm comm_;
  double limit_seconds_;
  std::chrono::steady_clock::time_point begin_, last_;
  std::int64_t last_step_ = -1, next_ = 0;
  struct Answer {  // the maximum over ranks
    double signal = 0, late = 0, step_seconds = 1;
  };
  Answer answer_;
  parallel::PendingMaxima<Answer> asked_;
};

}  // namespace silt
