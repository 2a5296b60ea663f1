#include "silt/run/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "adapters/hdf5/disk.hpp"

namespace silt {

namespace {

// Seconds between two lines on a terminal, and in a log or pipe.
constexpr double terminal_interval = 0.2, log_interval = 10;

double seconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double>(d).count();
}

/// Returns "4 s", "3 min 20 s", "2 h 05 min".
std::string duration_text(double s) {
  const auto t = std::int64_t{std::lround(s)};
  if (t < 60) return fmt::format("{} s", t);
  if (t < 3600) return fmt::format("{} min {:02} s", t / 60, t % 60);
  return fmt::format("{} h {:02} min", t / 3600, t % 3600 / 60);
}

/// Returns whether the parent process writes to a terminal.
bool is_on_terminal_above() {
  std::error_code error;
  const auto target =
      std::filesystem::read_symlink(fmt::format("/proc/{}/fd/{}", getppid(), STDOUT_FILENO), error).string();
  return !error && (target.starts_with("/dev/pts/") || target.starts_with("/dev/tty"));
}

/// Returns whether a user watches the output, so that a line may be overwritten. mpirun gives its first rank
/// a terminal even if its own output goes to a file.
bool is_on_terminal() {
  const char* plain = std::getenv("SILT_PLAIN");
  if ((plain && *plain) || !isatty(STDOUT_FILENO)) return false;
  return !std::getenv("OMPI_COMM_WORLD_SIZE") || is_on_terminal_above();
}

}  // namespace

Progress::Progress(const RunExtent& run, bool loud, bool prints)
    : run_(run), loud_(loud), prints_(prints), terminal_(loud && prints && is_on_terminal()) {
  begin_ = shown_ = logged_ = Clock::now();
}

void Progress::open_log(const std::filesystem::path& log) {
  if (!loud_) return;
  log_ = std::fopen(log.c_str(), "a");
  if (!log_)
    throw std::runtime_error(
        fmt::format("{}: cannot be opened: {}", log.string(), adapters::system_reason(errno)));
}

Progress::~Progress() {
  if (log_) std::fclose(log_);
}

void Progress::clear_line() {
  if (width_ > 0) std::fputs(fmt::format("\r{:{}}\r", "", width_).c_str(), stdout);
  width_ = 0;
}

void Progress::say(const std::string& text) {
  if (!loud_) return;
  if (prints_) {
    clear_line();
    std::puts(text.c_str());
    std::fflush(stdout);
  }
  log(text);
}

void Progress::log(const std::string& text) {
  if (!log_) return;
  std::fprintf(log_, "%s\n", text.c_str());
  std::fflush(log_);
}

void Progress::step(std::int64_t step, double seconds_in_steps) {
  if (!loud_) return;
  const auto now = Clock::now();
  const bool shows = seconds(now - shown_) >= (terminal_ ? terminal_interval : log_interval);
  const bool logs = seconds(now - logged_) >= log_interval;
  if (!shows && !logs) return;
  const std::string text = line(step, seconds_in_steps);
  if (shows) show(text);
  if (logs) log(text), logged_ = now;
}

void Progress::show(const std::string& text) {
  if (!prints_) return;
  if (terminal_) {
    std::fputs(fmt::format("\r{:<{}}", text, width_).c_str(), stdout);
    width_ = std::max(width_, text.size());
  } else {
    std::puts(text.c_str());
  }
  std::fflush(stdout);
  shown_ = Clock::now();
}

void Progress::finish(std::int64_t step, double seconds_in_steps) {
  if (!log_) return;
  const std::string text = line(step, seconds_in_steps);
  show(text);
  if (terminal_) std::puts("");
  width_ = 0;
  log(text);
}

std::string Progress::line(std::int64_t step, double seconds_in_steps) const {
  const double elapsed = seconds(Clock::now() - begin_), done = double(step - run_.first_step);
  const double speed = seconds_in_steps > 0 ? done / seconds_in_steps : 0;
  std::string text =
      fmt::format("step {}/{} ({:.1f} %)", step, run_.steps, 100. * double(step) / double(run_.steps));
  if (run_.units.si) text += fmt::format("  {:.4g} s simulated", double(step) * run_.units.time_step);
  text += run_.fluid_cells > 0 ? fmt::format("  {:.2f} MLUPS", speed * run_.fluid_cells * 1e-6)
                               : fmt::format("  {:.4g} steps/s", speed);
  text += fmt::format("  {} elapsed", duration_text(elapsed));
  if (step < run_.steps && done > 0)
    text += fmt::format(", {} left", duration_text(double(run_.steps - step) / done * elapsed));
  return text;
}

}  // namespace silt
