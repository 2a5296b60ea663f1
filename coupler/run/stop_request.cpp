#include "coupler/run/stop_request.hpp"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <ctime>

namespace silt::coupler {

namespace {
constexpr int requests[] = {SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};
volatile std::sig_atomic_t caught = 0;
volatile std::time_t caught_at = 0;

/// Launchers pass a signal on that comes from the terminal too: only what comes later is impatience.
void note(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (caught && now.tv_sec > caught_at + 1) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // comes when this handler ends
  }
  if (!caught) caught_at = now.tv_sec;
  caught = signal;
}
double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}
}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  for (const int signal : requests) sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

StopRequest::StopRequest(MPI_Comm comm, double limit_seconds)
    : comm_(comm), limit_seconds_(limit_seconds), begin_(std::chrono::steady_clock::now()), last_(begin_) {}

std::string StopRequest::why(std::int64_t step) {
  if (step < next_) return "";
  const auto now = std::chrono::steady_clock::now();
  const std::int64_t steps = std::max<std::int64_t>(1, step - last_step_);
  const bool late = limit_seconds_ > 0 && seconds(now - begin_) > limit_seconds_;
  double asked[3] = {double(caught), late ? 1.0 : 0.0,
                     last_step_ < 0 ? 1.0 : seconds(now - last_) / double(steps)};
  MPI_Allreduce(MPI_IN_PLACE, asked, 3, MPI_DOUBLE, MPI_MAX, comm_);
  last_ = now;
  last_step_ = step;
  next_ = step + std::clamp<std::int64_t>(std::int64_t(agreement_seconds / std::max(asked[2], 1e-9)), 1,
                                          most_steps_between);
  if (asked[0] > 0) return std::string("told to stop (SIG") + sigabbrev_np(int(asked[0])) + ")";
  if (asked[1] > 0) return "the time limit is reached";
  return "";
}

}  // namespace silt::coupler
