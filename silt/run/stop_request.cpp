#include "silt/run/stop_request.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <ctime>

namespace silt {

namespace {
constexpr int requests[] = {SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};
volatile std::sig_atomic_t caught = 0;
volatile std::time_t caught_at = 0;

/// A launcher may pass on a signal that the terminal sent, too; only a later signal ends the process.
void note(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (caught && now.tv_sec > caught_at + 1) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // delivered when this handler ends
  }
  if (caught) return;
  caught_at = now.tv_sec;
  caught = signal;
}
double in_seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}
}  // namespace

void catch_signals() {
  caught = 0;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  for (const int signal : requests) sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

StopRequest::StopRequest(MPI_Comm comm, double limit_seconds)
    : comm_(comm), limit_seconds_(limit_seconds), begin_(std::chrono::steady_clock::now()), last_(begin_) {}

void StopRequest::ask(std::int64_t step) {
  const auto now = std::chrono::steady_clock::now();
  const double late = limit_seconds_ > 0 && in_seconds(now - begin_) > limit_seconds_;
  const auto steps = double(std::max<std::int64_t>(1, step - last_step_));
  asked_.start(
      comm_, {double(caught), late, last_step_ < 0 ? answer_.step_seconds : in_seconds(now - last_) / steps});
  last_ = now;
  last_step_ = step;
}

void StopRequest::take_answer() {
  if (asked_.under_way()) answer_ = asked_.finish();
}

/// Returns e.g. "told to stop by SIGINT (Ctrl-C)".
std::string signal_text(int signal) {
  const char* why = "";
  if (signal == SIGINT) why = " (Ctrl-C)";
  if (signal == SIGHUP) why = " (the terminal was closed)";
  if (signal == SIGTERM && std::getenv("OMPI_COMM_WORLD_SIZE")) why = " (mpirun sends it on Ctrl-C, too)";
  return std::string("told to stop by SIG") + sigabbrev_np(signal) + why;
}

std::string StopRequest::why(std::int64_t step) {
  if (step < next_) return "";
  take_answer();
  ask(step);
  if (answer_.step_seconds > longest_overlapped) take_answer();
  next_ =
      step + std::clamp<std::int64_t>(std::int64_t(between_questions / std::max(answer_.step_seconds, 1e-9)),
                                      1, most_steps_between);
  if (answer_.signal > 0) return signal_text(int(answer_.signal));
  if (answer_.late > 0) return "the time limit is reached";
  return "";
}

}  // namespace silt
