#pragma once
// What both halves of the module need: read-only numpy arrays, and calls without the interpreter's lock.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <utility>
#include <vector>

#include "silt/python/live_simulation.hpp"

namespace silt {

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

}  // namespace silt
