#pragma once
// Who may ask a run to stop in good order: a signal, a limit of wall-clock time.
#include <mpi.h>

#include <chrono>
#include <cstdint>
#include <string>

namespace silt::coupler {

/// Makes SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2 and SIGXCPU only leave a note from now on, process-wide;
/// another one a second later or more ends the process. SIGPIPE is ignored: nobody has to read what a run
/// prints.
void catch_signals();

/// Asks all ranks, every few steps, whether any of them has been told to stop.
class StopRequest {
 public:
  /// Begins a limit of limit_seconds of wall-clock time from now; 0: none.
  StopRequest(MPI_Comm, double limit_seconds);
  /// Collective, after every step; talks to the others only every agreement_seconds or so. Returns why all
  /// ranks stop now, or "".
  std::string why(std::int64_t step);

 private:
  // A signal is noticed this long after it came, seconds; the question costs a reduction.
  static constexpr double agreement_seconds = 0.2;
  static constexpr std::int64_t most_steps_between = 1000;
  MPI_Comm comm_;
  double limit_seconds_;
  std::chrono::steady_clock::time_point begin_, last_;
  std::int64_t last_step_ = -1, next_ = 0;
};

}  // namespace silt::coupler
