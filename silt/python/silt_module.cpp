// The Python module `silt`: a case, its steps, and numpy arrays of its bodies and fields (README.md).
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "coupler/state_hash.hpp"
#include "cpu/environment.hpp"
#include "parallel/collectives.hpp"
#include "parallel/communicator.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_file.hpp"
#include "silt/python/live_simulation.hpp"
#include "silt/results/build_info.hpp"
#include "silt/results/flow_fields.hpp"
#include "silt/run/run.hpp"

namespace py = pybind11;

namespace silt {
namespace {

using Three = std::array<double, 3>;
using Four = std::array<double, 4>;

/// Calls work(simulation) without the interpreter's lock, so that other threads continue.
template <class Work>
auto with(LiveSimulation& live, Work&& work) {
  const py::gil_scoped_release released;
  return live.with(std::forward<Work>(work));
}

rigid::Vec3 vector(const char* what, const Three& x) {
  if (!std::all_of(x.begin(), x.end(), [](double c) { return std::isfinite(c); }))
    throw std::invalid_argument(
        fmt::format("{} is ({}, {}, {}); it must be of finite numbers", what, x[0], x[1], x[2]));
  return {x[0], x[1], x[2]};
}

rigid::Quat quaternion(const Four& wxyz) {
  const rigid::Quat q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (const double norm = q.norm(); !(norm > 0) || !std::isfinite(norm))
    throw std::invalid_argument(
        fmt::format("orientation is ({}, {}, {}, {}); it must be a quaternion w, x, y, z", wxyz[0], wxyz[1],
                    wxyz[2], wxyz[3]));
  return q;
}

// ---- arrays ----

py::array read_only(py::array array) {
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

// ---- a simulation ----

std::vector<std::string> overrides_of(const std::vector<std::string>& set,
                                      const std::vector<std::string>& unset) {
  std::vector<std::string> overrides;
  for (const std::string& argument : set) {
    if (const std::string wrong = complaint_of_set(argument); !wrong.empty())
      throw std::invalid_argument("set: " + wrong);
    overrides.push_back(argument);
  }
  for (const std::string& key : unset) {
    if (const std::string wrong = complaint_of_unset(key); !wrong.empty())
      throw std::invalid_argument("unset: " + wrong);
    overrides.push_back(key + "=");
  }
  return overrides;
}

std::unique_ptr<LiveSimulation> opened(const std::filesystem::path& directory,
                                       const std::vector<std::string>& set,
                                       const std::vector<std::string>& unset,
                                       const std::optional<std::filesystem::path>& out, bool overwrite,
                                       bool resume) {
  if (!out && (overwrite || resume))
    throw std::invalid_argument("overwrite and resume are of a folder of results: give out as well");
  RunOptions options;
  options.directory = directory;
  options.overrides = overrides_of(set, unset);
  options.out = out;
  options.overwrite = overwrite;
  std::unique_ptr<LiveSimulation> live;
  {
    const py::gil_scoped_release released;
    live = std::make_unique<LiveSimulation>(options, resume, MPI_COMM_WORLD);
  }
  for (const std::string& warning : live->warnings())
    if (live->get().scene().rank == 0 && PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 1) != 0)
      throw py::error_already_set();
  return live;
}

/// Runs the simulation; on a single rank an interrupt ends the run at the next check of the fluid.
void run(LiveSimulation& live, std::optional<std::int64_t> wanted) {
  if (wanted && *wanted < 0)
    throw std::invalid_argument(fmt::format("steps is {}; it must be at least 0", *wanted));
  std::int64_t steps = wanted.value_or(live.get().setup().steps - live.get().steps_done());
  while (steps > 0 && !(live.writes() && live.has_ended())) {
    const std::int64_t now = std::min(steps, guard_interval);
    {
      const py::gil_scoped_release released;
      if (!live.writes()) live.with([&](Simulation& simulation) { simulation.run(now); });
      for (std::int64_t i = 0; live.writes() && i < now && !live.has_ended(); ++i) live.step();
    }
    steps -= now;
    if (live.get().scene().ranks == 1 && PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

py::array field(LiveSimulation& live, const std::string& name) {
  const std::vector<std::string> known = field_names.list();
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end())
    throw std::invalid_argument(fmt::format("there is no field '{}'{}", name, suggestion(name, known)));
  if (!live.get().scene().flow) throw std::invalid_argument("the case has no [fluid], so no fields");
  const auto which = static_cast<Field>(found - known.begin());
  auto* const here =
      new FieldHere(with(live, [&](const Simulation& simulation) { return field_here(simulation, which); }));
  const py::capsule owner(here, [](void* field) { delete static_cast<FieldHere*>(field); });
  std::vector<py::ssize_t> shape, strides;
  py::ssize_t stride = sizeof(double) * here->components;
  for (int d = 0; d < 3; ++d) {
    shape.push_back(here->box.size[d]);
    strides.push_back(stride);
    stride *= shape.back();
  }
  if (here->components > 1) shape.push_back(here->components), strides.push_back(sizeof(double));
  return py::array_t<double>(shape, strides, here->values.data(), owner);
}

py::tuple box(const Simulation& simulation) {
  const coupler::Flow* const flow = simulation.scene().flow.get();
  const lbm::CellBox here = flow ? box_of(*flow) : lbm::CellBox{};
  const auto corner = [](lbm::Int3 x) { return py::make_tuple(x.x, x.y, x.z); };
  return py::make_tuple(corner(here.lower), corner(here.lower + here.size));
}

py::dict units(const Simulation& simulation) {
  py::dict all;
  for (const auto& [name, of] : {std::pair{"length", dimension::length},
                                 {"time", dimension::time},
                                 {"mass", dimension::mass},
                                 {"density", dimension::density},
                                 {"velocity", dimension::velocity},
                                 {"angular_velocity", dimension::angular_velocity},
                                 {"acceleration", dimension::acceleration},
                                 {"momentum", dimension::momentum},
                                 {"force", dimension::force},
                                 {"torque", dimension::torque},
                                 {"energy", dimension::energy},
                                 {"pressure", dimension::pressure},
                                 {"viscosity", dimension::viscosity}})
    all[name] = simulation.setup().units.scale(of);
  return all;
}

/// Makes a property that reads the simulation.
template <class Of>
auto reads(Of of) {
  return [of](LiveSimulation& live) { return of(static_cast<const Simulation&>(live.get())); };
}

void bind_changes(py::class_<LiveSimulation>& simulation) {
  simulation
      .def(
          "add_force",
          [](LiveSimulation& live, rigid::BodyId id, const Three& force, const Three& torque) {
            const rigid::Vec3 f = vector("force", force), t = vector("torque", torque);
            with(live, [&](Simulation& s) { s.add_force(id, f, t); });
          },
          py::arg("id"), py::arg("force"), py::arg("torque") = Three{},
          "Gives body `id` a force and a torque about its centre of mass that act in the next step, once.")
      .def(
          "set_velocity",
          [](LiveSimulation& live, rigid::BodyId id, const Three& velocity, const Three& angular_velocity) {
            const rigid::Vec3 v = vector("velocity", velocity);
            const rigid::Vec3 w = vector("angular_velocity", angular_velocity);
            with(live, [&](Simulation& s) { s.set_velocity(id, v, w); });
          },
          py::arg("id"), py::arg("velocity"), py::arg("angular_velocity") = Three{},
          "Gives body `id` velocities; one that a case may not have is refused.")
      .def(
          "set_pose",
          [](LiveSimulation& live, rigid::BodyId id, const Three& position, const Four& orientation) {
            const rigid::Pose pose{vector("position", position), quaternion(orientation)};
            with(live, [&](Simulation& s) { s.set_pose(id, pose); });
          },
          py::arg("id"), py::arg("position"), py::arg("orientation") = Four{1, 0, 0, 0},
          "Moves body `id` to where it meets neither a wall nor another body and cells are finest, "
          "orientation\nw, x, y, z; its velocity stays.");
}

constexpr const char* about_simulation =
    R"(A case that advances in time, in lattice units. On several ranks each call is collective: every rank
makes the same calls with the same arguments. Properties are of this rank, and wait for no other.)";
constexpr const char* about_opening =
    R"(Reads and judges a case directory (or .toml file) as `silt run CASE --set ... --unset ...` does, and
starts at step 0. Raises CaseError with everything that is wrong, on every rank; warnings come as
UserWarning on rank 0. Without `out` it writes no files. With it, a folder, it writes there all that
`silt run CASE --out FOLDER` does; `overwrite` deletes earlier results there instead of moving them,
`resume` goes on from the newest checkpoint there. finish(), or the end of a with block, closes them.)";
constexpr const char* about_step =
    R"(Does one step. Raises GuardStop, on every rank, when the state has left the range in which it means
anything. What only one of several ranks meets would leave the others waiting: that rank says what
it is and ends all of them.)";
constexpr const char* about_field =
    R"(Makes a field of the fluid, an array [x, y, z] or [x, y, z, 3] of the cells of `box`, in lattice
units: velocity, density, pressure, shear-rate, body-id, vorticity. As in files of fields a cell in
a body has the body's velocity and id. Cells of other ranks are nan; on one rank there are none.)";

void bind_simulation(py::module_& module) {
  py::class_<LiveSimulation> simulation(module, "Simulation", about_simulation);
  simulation
      .def(py::init(&opened), py::arg("case"), py::arg("set") = std::vector<std::string>{},
           py::arg("unset") = std::vector<std::string>{}, py::arg("out") = std::nullopt,
           py::arg("overwrite") = false, py::arg("resume") = false, about_opening)
      .def("step", &LiveSimulation::step, py::call_guard<py::gil_scoped_release>(), about_step)
      .def("run", &run, py::arg("steps") = std::nullopt,
           "Does so many steps, with a look at all of the fluid every 100; errors as of step. Without a "
           "number, and\nwhere files are written at most, up to the end that the case has.")
      .def("finish", &LiveSimulation::finish, py::call_guard<py::gil_scoped_release>(),
           "Ends the files: report.json says how the run ended, before its last step with a checkpoint.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__",
           [](LiveSimulation& live, const py::object& error, const py::args&) {
             if (error.is_none() || live.get().scene().ranks == 1)
               live.finish();  // otherwise the error may be this rank's alone
           })
      .def_property_readonly("ended", &LiveSimulation::has_ended, "whether the case's last step is done")
      .def(
          "hash",
          [](LiveSimulation& live) {
            return coupler::hex(with(live, [](Simulation& s) { return s.hash(); }));
          },
          "state_hash of report.json: the same for the same state on any number of ranks.")
      .def("field", &field, py::arg("name"), about_field)
      .def_property_readonly("bodies", [](py::object self) { return Bodies{std::move(self)}; })
      .def_property_readonly("steps_done", reads([](const Simulation& s) { return s.steps_done(); }))
      .def_property_readonly("time", reads([](const Simulation& s) {
                               return double(s.steps_done()) * s.setup().units.time_step;
                             }),
                             "of the scene, in the units of the case")
      .def_property_readonly("units", reads(&units),
                             "one lattice unit of each quantity, in the units of the case: "
                             "force / units[\"force\"] is in lattice units")
      .def_property_readonly("cells",
                             reads([](const Simulation& s) { return py::tuple(py::cast(s.setup().cells)); }),
                             "of the domain, along x, y, z")
      .def_property_readonly("box", reads(&box),
                             "the smallest box of cells, [lower, upper), that has all of this rank's fluid")
      .def_property_readonly("kinds", reads([](const Simulation& s) { return s.setup().kind_names; }))
      .def_property_readonly("title", reads([](const Simulation& s) { return s.setup().title; }))
      .def_property_readonly("rank", reads([](const Simulation& s) { return s.scene().rank; }))
      .def_property_readonly("ranks", reads([](const Simulation& s) { return s.scene().ranks; }));
  bind_changes(simulation);
}

// ---- MPI in an interpreter ----

/// Makes a Python error on one rank end all ranks, which would wait for it.
void end_all_by_an_error() {
  const py::module_ sys = py::module_::import("sys");
  const py::object shown = sys.attr("excepthook");
  sys.attr("excepthook") = py::cpp_function([shown](const py::args& error) {
    shown(*error);
    py::module_::import("sys").attr("stderr").attr("flush")();
    std::fflush(nullptr);
    MPI_Abort(MPI_COMM_WORLD, 1);
  });
}

void join_mpi() {
  if (const std::string complaint = environment_error(); !complaint.empty())
    throw std::invalid_argument(complaint);
  if (start_mpi())
    py::module_::import("atexit").attr("register")(py::cpp_function([] {
      int ended = 0;
      MPI_Finalized(&ended);
      if (!ended) MPI_Finalize();
    }));
  const int ranks = parallel::ranks_of(MPI_COMM_WORLD);
  if (ranks > 1) end_all_by_an_error();
}

}  // namespace
}  // namespace silt

PYBIND11_MODULE(silt, module) {
  using namespace silt;
  module.doc() =
      "Runs cases of Silt: read case -> step -> look at bodies and fields -> add force.\n"
      "Importing it starts MPI, unless somebody has; then it also ends it when the interpreter does.\n"
      "On several ranks an error that nobody catches ends all ranks.";
  module.attr("__version__") = build_info().version;
  py::register_exception<UnfitCase>(module, "CaseError", PyExc_ValueError);
  py::register_exception<GuardStop>(module, "GuardStop", PyExc_RuntimeError);
  bind_bodies(module);
  bind_simulation(module);
  join_mpi();
}
