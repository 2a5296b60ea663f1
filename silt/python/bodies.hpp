#pragma once
// The bodies of a simulation as numpy arrays: views of those that this rank owns, and copies of any by id.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <utility>
#include <vector>

#include "silt/python/live_simulation.hpp"

namespace silt {

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
