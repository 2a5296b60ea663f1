#pragma once
// The bodies of a simulation as numpy arrays: views of those that this rank owns, and copies of any by id.
#include "silt/python/arrays.hpp"

namespace silt {

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
