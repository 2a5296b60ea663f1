#pragma once
// A simulation owned by an interpreter, which may keep it longer than MPI runs, and must not be affected by
// MPI_Abort or floating-point modes.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cfenv>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
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

// What both halves of the module need: read-only numpy arrays, and calls without the interpreter's lock.
namespace py = pybind11;

/// Calls work(simulation) without the interpreter's lock, so that other threads continue.
template <class Work>
auto with(LiveSimulation& live, Work&& work) {
  const py::gil_scoped_release released;
  return live.with(std::forward<Work>(work));
}

inline py::array read_only(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// Returns a view of `rows` rows of `columns` numbers (0: one number), kept alive by `owner`.
template <class T>
py::array view(const T* first, std::size_t rows, std::size_t columns, const py::object& owner) {
  std::vector<py::ssize_t> shape = {py::ssize_t(rows)};
  if (columns > 0) shape.push_back(py::ssize_t(columns));
  return read_only(py::array_t<T>(shape, first, owner));
}

/// Returns a new array [rows, width]; fill(row, values) sets each row.
template <class Fill>
py::array made(std::size_t rows, std::size_t width, Fill&& fill) {
  py::array_t<double> array(std::vector<py::ssize_t>{py::ssize_t(rows), py::ssize_t(width)});
  for (std::size_t row = 0; row < rows; ++row) fill(row, array.mutable_data(row, 0));
  return read_only(array);
}

/// The bodies that this rank owns.
struct Bodies {
  py::object simulation;  // a LiveSimulation

  const Simulation& get() const { return simulation.cast<LiveSimulation&>().get(); }
  std::size_t count() const { return get().bodies().owned; }
  py::array vectors(const std::vector<rigid::Vec3>& x) const {
    static_assert(sizeof(rigid::Vec3) == 3 * sizeof(double));
    return view(reinterpret_cast<const double*>(x.data()), count(), 3, simulation);
  }
  template <class T>
  py::array numbers(const std::vector<T>& x) const {
    return view(x.data(), count(), 0, simulation);
  }
  py::array image() const {
    return view(reinterpret_cast<const std::int32_t*>(get().bodies().image.data()), count(), 3, simulation);
  }
  py::array orientation() const {
    return made(count(), 4, [&](std::size_t row, double* wxyz) {
      const rigid::Quat& q = get().bodies().orientation[row];
      wxyz[0] = q.w(), wxyz[1] = q.x(), wxyz[2] = q.y(), wxyz[3] = q.z();
    });
  }
  py::array loads(rigid::Vec3 coupler::BodyLoad::*part) const {
    const std::vector<coupler::BodyLoad> all = get().last_loads();
    return made(count(), 3, [&](std::size_t row, double* x) { std::copy_n((all[row].*part).data(), 3, x); });
  }
};

/// Defines the class `Bodies` of the module.
void bind_bodies(py::module_&);

}  // namespace silt
