#pragma once
// A simulation owned by an interpreter, which may keep it longer than MPI runs, and must not be affected by
// MPI_Abort or floating-point modes.
#include <fmt/format.h>

#include <cfenv>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "cpu/isa.hpp"
#include "silt/guard.hpp"
#include "silt/run/run_outputs.hpp"
#include "silt/simulation.hpp"

namespace silt {

/// Sets the floating-point mode of `silt run` during its lifetime.
class RunArithmetic {
 public:
  RunArithmetic() {
    std::fegetenv(&before_);
    flush_denormals_to_zero();
  }
  RunArithmetic(const RunArithmetic&) = delete;
  ~RunArithmetic() { std::fesetenv(&before_); }

 private:
  std::fenv_t before_;
};

/// Says why a case cannot run, on every rank, in the lines of `silt run`.
struct UnfitCase : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Owns a simulation, which ends with it or when MPI is finalised. With a folder for results it writes the
/// files of `silt run`.
class LiveSimulation {
 public:
  /// Reads and checks a case like `silt run` or `silt resume`. Collective. Throws UnfitCase.
  LiveSimulation(const RunOptions&, bool resume, MPI_Comm);
  LiveSimulation(const LiveSimulation&) = delete;
  ~LiveSimulation();

  const std::vector<std::string>& warnings() const { return warnings_; }  // of the case
  /// Returns the simulation. Throws std::runtime_error after MPI is finalised.
  Simulation& get();
  /// Calls work(simulation). Rethrows errors that every rank has (CommonGuardStop, std::invalid_argument),
  /// and all errors on a single rank, a guard's as GuardStop. An error on one rank of several is reported and
  /// ends all ranks with MPI_Abort, since the others would wait for ever.
  template <class Work>
  auto with(Work&& work);

  bool writes() const { return files_ != nullptr; }
  bool has_ended() { return get().steps_done() >= get().setup().steps || prepared_.is_steady(); }
  /// Does one step and writes output that is due; calls finish() after the last step. Throws like with(), and
  /// std::invalid_argument after the last step of a run that writes or after finish().
  void step();
  /// Completes the output; before the last step with a checkpoint for `silt resume`.
  void finish();

 private:
  struct Files {
    Progress progress;
    RunOutputs outputs;
    Files(PreparedRun&, const std::filesystem::path&);
  };
  void end_files(const std::string& reason, const std::string& text, bool sound);
  static int end_all(MPI_Comm, int, void*, void*);
  static std::vector<LiveSimulation*>& living();
  [[noreturn]] void end_alone(const std::string& text) const;

  PreparedRun prepared_;
  std::unique_ptr<Files> files_;
  bool finished_ = false;
  std::vector<std::string> warnings_;
};

template <class Work>
auto LiveSimulation::with(Work&& work) {
  Simulation& simulation = get();
  const RunArithmetic arithmetic;
  const Scene& scene = simulation.scene();
  try {
    return work(simulation);
  } catch (const CommonGuardStop&) {
    throw;
  } catch (const std::invalid_argument&) {
    throw;
  } catch (const std::overflow_error& error) {
    const std::string text =
        overflow_text(scene.setup, error.what(), simulation.steps_done() + 1, scene.rank());
    if (scene.ranks() == 1) throw GuardStop(text);
    end_alone(text);
  } catch (const std::exception& error) {
    if (scene.ranks() == 1) throw;
    end_alone(fmt::format("step {}, rank {}: {}", simulation.steps_done() + 1, scene.rank(), error.what()));
  }
}

}  // namespace silt
