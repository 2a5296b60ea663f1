#include "silt/python/live_simulation.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>

#include "parallel/collectives.hpp"
#include "parallel/together.hpp"

namespace silt {

namespace {

PreparedRun prepared_or_unfit(const RunOptions& options, bool resume, MPI_Comm comm) {
  try {
    if (!options.out) return prepare_scene(options, comm);
    return (resume ? prepare_resume : prepare_run)(options, comm, *options.out);
  } catch (const std::exception& error) {
    throw UnfitCase(error.what());
  }
}

}  // namespace

LiveSimulation::Files::Files(PreparedRun& run, const std::filesystem::path& folder)
    : progress(run.extent(), run.simulation->scene().rank() == 0, false), outputs(run, folder, progress) {
  parallel::together(run.simulation->scene().comm, [&] { progress.open_log(folder / "run.log"); });
  outputs.begin_log();
  outputs.start();
}

LiveSimulation::LiveSimulation(const RunOptions& options, bool resume, MPI_Comm comm) {
  const RunArithmetic arithmetic;
  prepared_ = prepared_or_unfit(options, resume, comm);
  if (options.out) with([&](Simulation&) { files_ = std::make_unique<Files>(prepared_, *options.out); });
  for (const Diagnostic& warning : prepared_.warnings) warnings_.push_back(warning.line());
  static const bool told = [] {  // attributes of MPI_COMM_SELF are deleted first when MPI is finalised
    int key = MPI_KEYVAL_INVALID;
    MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, end_all, &key, nullptr);
    MPI_Comm_set_attr(MPI_COMM_SELF, key, nullptr);
    return true;
  }();
  (void)told;
  living().push_back(this);
}

LiveSimulation::~LiveSimulation() {
  std::erase(living(), this);
}

Simulation& LiveSimulation::get() {
  if (!prepared_.simulation) throw std::runtime_error("the simulation has ended: MPI is finalised");
  return *prepared_.simulation;
}

void LiveSimulation::step() {
  with([&](Simulation& simulation) {
    if (!files_) return simulation.step();
    if (finished_)
      throw std::invalid_argument(
          fmt::format("step {} was the last one: its report says how it ended; for more raise run.steps",
                      simulation.steps_done()));
    try {
      simulation.step();
      prepared_.quantities->observe(simulation);
      prepared_.watch();
      files_->outputs.write_due();
    } catch (const GuardStop& stop) {
      if (simulation.scene().ranks() > 1 && !dynamic_cast<const CommonGuardStop*>(&stop)) throw;
      end_files("guard", stop.what(), false);
      throw;
    }
    files_->progress.step(simulation.steps_done(), simulation.step_seconds());
  });
  if (files_ && has_ended()) finish();
}

void LiveSimulation::finish() {
  if (!files_ || finished_) return;
  with([&](Simulation& simulation) {
    if (has_ended()) return end_files(prepared_.reason_of_end(), prepared_.text_of_end(), true);
    const auto& coarsening = simulation.setup().coarsening;  // ends a step of the coarsest cells
    if (coarsening && simulation.steps_done() % coarsening->stride() != 0)
      throw std::invalid_argument(
          fmt::format("finish: cells of several levels end their steps together each {} steps; {} are done",
                      coarsening->stride(), simulation.steps_done()));
    const std::string text = fmt::format("the program ended it at step {}", simulation.steps_done());
    files_->outputs.interrupt(text);
    end_files("interrupted", text, true);
  });
}

void LiveSimulation::end_files(const std::string& reason, const std::string& text, bool sound) {
  finished_ = true;
  Simulation& simulation = get();
  files_->progress.finish(simulation.steps_done(),
                          parallel::max_over_ranks(simulation.scene().comm, simulation.step_seconds()));
  if (!text.empty()) files_->progress.log(text);
  files_->outputs.write_report(reason, text, sound);
  prepared_.folder.lock.reset();
}

int LiveSimulation::end_all(MPI_Comm, int, void*, void*) {
  for (LiveSimulation* const one : living()) one->files_.reset(), one->prepared_ = {};
  return MPI_SUCCESS;
}

std::vector<LiveSimulation*>& LiveSimulation::living() {
  static std::vector<LiveSimulation*> all;
  return all;
}

void LiveSimulation::end_alone(const std::string& text) const {
  fmt::print(stderr, "silt: {}\n", text);
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

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
