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
#include "cpu/isa.hpp"
#include "parallel/communicator.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_file.hpp"
#include "silt/python/live_simulation.hpp"
#include "silt/results/build_info.hpp"
#include "silt/results/flow_fields.hpp"
#include "silt/run/run.hpp"

namespace silt {
namespace {

using Three = std::array<double, 3>;
using Four = std::array<double, 4>;

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
    if (live->get().scene().rank() == 0 && PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 1) != 0)
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
    if (live.get().scene().ranks() == 1 && PyErr_CheckSignals() != 0) throw py::error_already_set();
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
           "Does this number of steps and checks all of the fluid every 100; errors as of step. Without a "
           "number, and\nwhere files are written at most, up to the end that the case has.")
      .def("finish", &LiveSimulation::finish, py::call_guard<py::gil_scoped_release>(),
           "Ends the files: report.json says how the run ended, before its last step with a checkpoint.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__",
           [](LiveSimulation& live, const py::object& error, const py::args&) {
             if (error.is_none() || live.get().scene().ranks() == 1)
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
      .def_property_readonly("rank", reads([](const Simulation& s) { return s.scene().rank(); }))
      .def_property_readonly("ranks", reads([](const Simulation& s) { return s.scene().ranks(); }));
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
