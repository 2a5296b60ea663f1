#pragma once
// A simulation in the hands of a program that may keep it longer than MPI lasts, and that knows neither of
// MPI_Abort nor of floating-point modes: an interpreter.
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

/// While this lives, numbers are computed as in `silt run`; afterwards as they were before.
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

/// UnfitCase says why a case cannot run, on every rank: the lines of `silt run`.
struct UnfitCase : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// LiveSimulation owns a simulation, which ends with it or when MPI is finalised, by whomever. With a folder
/// for results it writes what `silt run` does.
class LiveSimulation {
 public:
  /// Collective. Reads and judges a case as `silt run` does, or as `silt resume`. UnfitCase.
  LiveSimulation(const RunOptions&, bool resume, MPI_Comm);
  LiveSimulation(const LiveSimulation&) = delete;
  ~LiveSimulation();

  const std::vector<std::string>& warnings() const { return warnings_; }  // of the case
  /// Returns the simulation; std::runtime_error once MPI is finalised.
  Simulation& get();
  /// Does work(simulation). What every rank finds alike it throws: CommonGuardStop, std::invalid_argument.
  /// What this rank meets alone it throws if there is no other, as GuardStop where a guard told it; else the
  /// others would wait for ever: it says what it was, and ends all with MPI_Abort.
  template <class Work>
  auto with(Work&& work);

  bool writes() const { return files_ != nullptr; }
  bool has_ended() { return get().steps_done() >= get().setup().steps || prepared_.is_steady(); }
  /// One step, and what is to be written after it; after the last one also finish(). Errors as of `with`;
  /// std::invalid_argument after the last step of a run that writes, or after finish.
  void step();
  /// Ends what is written: before the last step with a checkpoint, from which `silt resume` goes on.
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
        overflow_text(scene.setup, error.what(), simulation.steps_done() + 1, scene.rank);
    if (scene.ranks == 1) throw GuardStop(text);
    end_alone(text);
  } catch (const std::exception& error) {
    if (scene.ranks == 1) throw;
    end_alone(fmt::format("step {}, rank {}: {}", simulation.steps_done() + 1, scene.rank, error.what()));
  }
}

}  // namespace silt
