#pragma once
// Requests to stop a run in good order: a signal, a limit of wall-clock time.
#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <string>

#include "parallel/pending_sums.hpp"

namespace silt {

/// Makes SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2 and SIGXCPU only leave a note from now on, process-wide;
/// another one a second later or more ends the process. SIGPIPE is ignored.
void catch_signals();

/// Asks all ranks, every few steps, whether any of them has been told to stop. The answer is looked at when
/// the next question is due, so that no step waits for it; at once if steps take longer than
/// longest_overlapped.
class StopRequest {
 public:
  /// Begins a limit of limit_seconds of wall-clock time from now; 0: none.
  StopRequest(MPI_Comm, double limit_seconds);
  /// Collective, after every step. Returns why all ranks stop now, or "": a signal is known of after two
  /// questions, 2 * between_questions or two steps, of slow steps at most 2 * most_steps_between.
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
  struct Answer {  // the largest of all ranks
    double signal = 0, late = 0, step_seconds = 1;
  };
  Answer answer_;
  parallel::PendingMaxima<Answer> asked_;
};

}  // namespace silt
