#include "silt/python/bodies.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <span>

#include "parallel/collectives.hpp"

namespace silt {
namespace {

/// A body as every rank gets it from the one that has it.
struct OneBody {
  rigid::BodyId id;
  std::int64_t kind, image[3];
  double mass, position[3], velocity[3], angular_velocity[3], orientation[4], force[3], torque[3];
};

/// Returns this rank's, of all that it has or of those with the ids, which are sorted.
std::vector<OneBody> bodies_here(const Simulation& simulation,
                                 const std::optional<std::vector<rigid::BodyId>>& ids) {
  const rigid::BodySet& bodies = simulation.bodies();
  const std::vector<coupler::BodyLoad> loads = simulation.last_loads();
  const auto store = [](const rigid::Vec3& v, double* to) { std::copy_n(v.data(), 3, to); };
  std::vector<OneBody> here;
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    if (ids && !std::ranges::binary_search(*ids, bodies.id[row])) continue;
    OneBody one{};
    one.id = bodies.id[row], one.kind = bodies.kind[row], one.mass = bodies.mass[row];
    std::copy_n(bodies.image[row].data(), 3, one.image);
    store(bodies.position[row], one.position), store(bodies.velocity[row], one.velocity);
    store(bodies.angular_velocity[row], one.angular_velocity);
    store(bodies.orientation[row].vec(), one.orientation + 1),
        one.orientation[0] = bodies.orientation[row].w();
    store(loads[row].force, one.force), store(loads[row].torque, one.torque);
    here.push_back(one);
  }
  return here;
}

/// Collective. Arrays of the bodies that are asked for, in their order, or of all; the same on every rank.
py::dict by_id(const Bodies& bodies, const std::optional<std::vector<rigid::BodyId>>& ids) {
  std::optional<std::vector<rigid::BodyId>> sorted = ids;
  if (sorted) std::ranges::sort(*sorted);
  std::vector<OneBody> rows =
      with(bodies.simulation.cast<LiveSimulation&>(), [&](const Simulation& simulation) {
        const std::vector<OneBody> here = bodies_here(simulation, sorted);
        return parallel::gathered(simulation.scene().comm, std::span(here), parallel::GatherTo::all_ranks);
      });
  std::ranges::sort(rows, {}, &OneBody::id);
  if (ids) {
    std::vector<OneBody> asked;
    for (const rigid::BodyId id : *ids) {
      const auto found = std::ranges::lower_bound(rows, id, {}, &OneBody::id);
      if (found == rows.end() || found->id != id)
        throw std::invalid_argument(fmt::format("there is no body {}", id));
      asked.push_back(*found);
    }
    rows = std::move(asked);
  }
  py::dict all;
  const auto add = [&](const char* name, auto member) {
    using Member = std::remove_reference_t<decltype(std::declval<OneBody&>().*member)>;
    using Number = std::remove_extent_t<Member>;
    std::vector<py::ssize_t> shape = {py::ssize_t(rows.size())};
    if (std::is_array_v<Member>) shape.push_back(sizeof(Member) / sizeof(Number));
    py::array_t<Number> array(shape);
    char* to = reinterpret_cast<char*>(array.mutable_data());
    for (const OneBody& row : rows)
      to = std::copy_n(reinterpret_cast<const char*>(&(row.*member)), sizeof(Member), to);
    all[name] = read_only(array);
  };
  add("id", &OneBody::id), add("kind", &OneBody::kind), add("mass", &OneBody::mass);
  add("position", &OneBody::position), add("image", &OneBody::image), add("velocity", &OneBody::velocity);
  add("angular_velocity", &OneBody::angular_velocity), add("orientation", &OneBody::orientation);
  add("force", &OneBody::force), add("torque", &OneBody::torque);
  return all;
}

}  // namespace

void bind_bodies(py::module_& module) {
  const auto vectors = [](std::vector<rigid::Vec3> rigid::BodySet::*column) {
    return [column](const Bodies& bodies) { return bodies.vectors(bodies.get().bodies().*column); };
  };
  py::class_<Bodies>(
      module, "Bodies",
      "The bodies whose centre this rank has, sorted by id, as read-only arrays of a row each, in lattice "
      "units.\nWhat is not said to be a copy is a view of the simulation's own numbers: it follows them, "
      "and is valid until the next\ncall that changes the simulation; to keep values, copy them.")
      .def("__len__", &Bodies::count)
      .def("by_id", &by_id, py::arg("ids") = std::nullopt,
           "Collective. The same numbers of the bodies with these ids, in their order, or of all bodies, "
           "whichever "
           "ranks\nhave them: a dict of arrays, alike on every rank; copies. ValueError where there is no "
           "such body.")
      .def_property_readonly("id", [](const Bodies& b) { return b.numbers(b.get().bodies().id); })
      .def_property_readonly(
          "kind", [](const Bodies& b) { return b.numbers(b.get().bodies().kind); }, "of simulation.kinds")
      .def_property_readonly("mass", [](const Bodies& b) { return b.numbers(b.get().bodies().mass); })
      .def_property_readonly("position", vectors(&rigid::BodySet::position),
                             "[bodies, 3], centre of mass, wrapped into the domain")
      .def_property_readonly("image", &Bodies::image, "[bodies, 3], how often it crossed each periodic side")
      .def_property_readonly("velocity", vectors(&rigid::BodySet::velocity), "[bodies, 3]")
      .def_property_readonly("angular_velocity", vectors(&rigid::BodySet::angular_velocity), "[bodies, 3]")
      .def_property_readonly("orientation", &Bodies::orientation,
                             "[bodies, 4], quaternion w, x, y, z from the body's frame; a copy")
      .def_property_readonly(
          "force", [](const Bodies& b) { return b.loads(&coupler::BodyLoad::force); },
          "[bodies, 3], what the fluid gave in the last step, and a program added; a copy")
      .def_property_readonly(
          "torque", [](const Bodies& b) { return b.loads(&coupler::BodyLoad::torque); },
          "[bodies, 3], about the centre of mass, as force; a copy");
}

}  // namespace silt
