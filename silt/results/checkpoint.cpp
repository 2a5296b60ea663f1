#include "silt/results/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <limits>
#include <sstream>

#include "adapters/hdf5/body_series.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "parallel/together.hpp"
#include "silt/case/case.hpp"
#include "silt/results/definitions.hpp"

namespace silt {

namespace {

using adapters::CheckpointReader;
using adapters::CheckpointWriter;

// ---- numbers in /state: one list for writing and reading ----

constexpr std::int64_t most = std::int64_t{1} << 62;  // of counters, so that later steps do not overflow
constexpr std::int64_t last_step = std::int64_t{1} << 53;

/// Visits the numbers of a state with names and allowed ranges.
template <class Visit>
void visit_state(SavedState& s, Visit&& visit) {
  visit("step", s.step, 0, last_step);
  visit_counters(s.counters, visit);
  visit("initial_mass_deviation", s.initial.mass_deviation);
  visit("initial_fluid_cells", s.initial.fluid_cells);
  visit("initial_momentum_x", s.initial.momentum[0]);
  visit("initial_momentum_y", s.initial.momentum[1]);
  visit("initial_momentum_z", s.initial.momentum[2]);
  visit("initial_momentum_scale", s.initial.momentum_scale);
  visit("next_id", s.next_id, 1, most);
  visit("momentum_brought_x", s.momentum_brought.q[0]);
  visit("momentum_brought_y", s.momentum_brought.q[1]);
  visit("momentum_brought_z", s.momentum_brought.q[2]);
  visit("mass_taken", s.mass_taken);
  visit("fluid_speed", s.fluid_speed, 0);
  visit("density_deviation", s.density_deviation, 0);
}

template <class Visit>
void visit_flow_control(coupler::FlowControl::State& state, Visit&& visit) {
  for (const auto& [name, vector] : {std::pair("force", &state.force),
                                     {"force_before", &state.force_before},
                                     {"velocity", &state.velocity},
                                     {"velocity_before", &state.velocity_before}})
    for (int d = 0; d < 3; ++d) visit(fmt::format("flow_control.{}_{}", name, "xyz"[d]), (*vector)[d]);
}

template <class Visit>
void visit_steady_watch(SteadyWatch::State& state, Visit&& visit) {
  visit("steady.looks", state.looks, 0, last_step);
  visit("steady.value", state.value);
  visit("steady.last_change", state.last_change);
  visit("steady.within", state.within, 0, last_step);
}

/// Writes 128-bit numbers as two of 64 bits.
struct Write {
  CheckpointWriter& writer;

  void operator()(const std::string& name, double x, double = 0) const { writer.set(name, x); }
  template <std::integral T>
  void operator()(const std::string& name, T x, std::int64_t, std::int64_t) const {
    writer.set(name, std::int64_t(x));
  }
  void operator()(const std::string& name, rigid::FixedSum sum) const {
    writer.set(name + ".low", std::int64_t(sum));
    writer.set(name + ".high", std::int64_t(sum >> 64));
  }
  void operator()(const CounterName& name, double x) const { writer.set(name.checkpoint, x); }
  void operator()(const CounterName& name, std::uint64_t x) const { (*this)(name.checkpoint, x, 0, most); }
};

struct Read {
  const CheckpointReader& reader;

  void operator()(const std::string& name, double& x,
                  double least = std::numeric_limits<double>::lowest()) const {
    x = reader.number(name);
    if (!(x >= least && x < std::numeric_limits<double>::infinity()))
      reader.refuse(fmt::format("/state/{} is {}, and must be a number from {} on", name, x, least));
  }
  template <std::integral T>
  void operator()(const std::string& name, T& x, std::int64_t least, std::int64_t greatest) const {
    const std::int64_t found = reader.integer(name);
    if (found < least || found > greatest)
      reader.refuse(fmt::format("/state/{} is {}, and must be from {} to {}", name, found, least, greatest));
    x = static_cast<T>(found);
  }
  void operator()(const std::string& name, rigid::FixedSum& sum) const {
    std::int64_t high = 0;
    (*this)(name + ".high", high, -(most / 2), most / 2);
    sum = (rigid::FixedSum(high) << 64) | std::uint64_t(reader.integer(name + ".low"));
  }
  void operator()(const CounterName& name, double& x) const { (*this)(name.checkpoint, x, 0); }
  void operator()(const CounterName& name, std::uint64_t& x) const { (*this)(name.checkpoint, x, 0, most); }
};

/// Visits the means of unfinished rows of series, with names that identify the rows, and definitions.
template <class Means, class Visit>
void visit_means(const Case& setup, Means& means, Visit&& visit) {
  for (std::size_t s = 0; s < means.size(); ++s) {
    const ColumnsSpec& series = setup.output.series[s];
    if (series.mean_of == 1) continue;
    for (std::size_t k = 0; k < means[s].size(); ++k)
      visit(mean_name(series, k), definition_of(setup, series, k), means[s][k]);
  }
}

// ---- bodies ----

void write_bodies(CheckpointWriter& writer, const rigid::BodySet& bodies) {
  using Impulses = std::vector<rigid::StoredImpulse>;
  writer.bodies({bodies.owned, [&](std::size_t row) { return bodies.record(row); },
                 [&](std::size_t row) -> const Impulses& { return bodies.stored_impulses[row]; }},
                saved_columns());
}

/// Returns the state of a simulation without bodies and populations.
SavedState numbers_of(const Simulation& simulation) {
  SavedState state;
  state.step = simulation.steps_done();
  state.counters = simulation.counters();
  state.initial = simulation.initial_balance();
  state.next_id = simulation.next_id();
  state.momentum_brought = simulation.momentum_brought();
  state.fluid_speed = simulation.fluid_speed();
  state.density_deviation = simulation.density_deviation();
  state.mass_taken = simulation.mass_taken();
  return state;
}

void write_state(CheckpointWriter& writer, const Simulation& simulation, const RunHistory& run) {
  const Case& setup = simulation.setup();
  SavedState state = numbers_of(simulation);
  const auto history = run.quantities.history(simulation);
  writer.set("time", double(state.step) * setup.units.time_step);
  writer.set("overrides", joined_lines(setup.overrides));
  writer.set("files", joined_lines(setup.files));
  visit_state(state, Write{writer});
  write_origin_of_start(writer, setup, state.step);
  for (std::size_t i = 0; i < history.size(); ++i) {
    const QuantitySpec& q = setup.quantities[i];
    for (std::size_t k = 0; k < history[i].size(); ++k) writer.set(history_name(q, k), history[i][k]);
    writer.set(definition_name(history_name(q, 0)), definition_of(q));
  }
  visit_means(setup, run.quantities.means(),
              [&](const std::string& name, const std::string& definition, const StepMean& mean) {
                writer.set(name + ".sum", mean.sum), writer.set(name + ".count", mean.count);
                writer.set(definition_name(name), definition);
              });
  if (run.steady) {
    writer.set(definition_name(watch_name), definition_of(setup, *setup.steady));
    SteadyWatch::State watch = run.steady->state();
    visit_steady_watch(watch, Write{writer});
  }
  if (const coupler::Flow* flow = simulation.scene().flow.get()) {
    if (coupler::FlowControl* const control = simulation.scene().flow->control()) {
      coupler::FlowControl::State of_control = control->state();
      visit_flow_control(of_control, Write{writer});
    }
    write_populations(writer, setup, *flow);
  }
  write_bodies(writer, simulation.bodies());
}

}  // namespace

std::string joined_lines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<adapters::AttachedColumn> saved_columns() {
  using Column = adapters::AttachedColumn;
  std::vector<Column> columns;
  const coupler::CouplingState state;
  visit_columns(state, [&]<class T>(const coupler::CouplingColumn& c, std::span<const T> numbers) {
    const auto offset = std::as_bytes(numbers).data() - reinterpret_cast<const std::byte*>(&state);
    constexpr Column::Type type = std::is_same_v<T, double> ? Column::float64 : Column::int64;
    if (c.saved) columns.push_back({c.name, type, std::size_t(offset), int(numbers.size())});
  });
  return columns;
}

std::filesystem::path write_checkpoint(const Simulation& simulation, const RunHistory& run,
                                       const std::filesystem::path& folder,
                                       const adapters::Provenance& provenance, const std::string& name) {
  const auto path = adapters::step_path(folder, name, simulation.steps_done(), ".h5");
  parallel::with_file_name(path.string(), [&] {
    CheckpointWriter writer(simulation.scene().comm, path, provenance);
    write_state(writer, simulation, run);
    if (run.mean) run.mean->save(writer, simulation);
    std::vector<std::filesystem::path> before = adapters::body_series_files(folder / "bodies.h5");
    before.insert(before.end(), {folder / "series.csv", folder / "departures.csv"});
    const OutputSpec& output = simulation.setup().output;
    for (const ColumnsSpec& series : output.series) before.push_back(folder / (series.name + ".csv"));
    for (const ProbesSpec& probes : output.probes) before.push_back(folder / (probes.name + ".csv"));
    writer.commit(output.keep_checkpoints, before);
  });
  return path;
}

CaseOrigin read_origin(const CheckpointReader& reader) {
  return {reader.case_text(), split_lines(reader.text("overrides")), split_lines(reader.text("files"))};
}

SavedState read_state(const CheckpointReader& reader, const Case& setup) {
  SavedState state;
  visit_state(state, Read{reader});
  const std::int64_t named = adapters::checkpoint_step(reader.path()).value_or(state.step);
  if (state.step != named)
    reader.refuse(fmt::format("it is of step {}, by its name of step {}", state.step, named));
  auto bodies = reader.bodies(saved_columns());
  try {
    parallel::together(reader.comm(), [&] { require_possible(setup, bodies, state.next_id); });
  } catch (const std::runtime_error& error) {  // on every rank
    reader.refuse(error.what());
  }
  state.bodies = {std::move(bodies.records), std::move(bodies.impulses)};
  if (!setup.fluid) return state;
  if (!setup.fluid->superficial_velocity.isZero(0)) visit_flow_control(state.flow_control, Read{reader});
  if (const std::string fault = fault_of_populations(reader, setup); !fault.empty()) reader.refuse(fault);
  if (has_temperature(reader) != setup.heat.has_value())
    reader.refuse(setup.heat ? "its fluid has no temperature, that of the case has one"
                             : "its fluid has a temperature, that of the case has none");
  if (setup.coarsening)
    state.levels = [&reader, coarsest = setup.coarsening->levels](const lbm::CellBox& part) {
      return saved_levels(reader, coarsest, part);
    };
  return state;
}

std::unique_ptr<Simulation> resumed_simulation(const CheckpointReader& reader, Case setup, MPI_Comm comm) {
  const SavedState state = read_state(reader, setup);
  return std::make_unique<Simulation>(
      std::move(setup), comm, state,
      [&](const Case& of, coupler::Flow& flow) { read_populations(reader, of, flow); });
}

std::optional<SteadyWatch> read_steady_watch(const CheckpointReader& reader, const Case& setup) {
  if (!setup.steady) return {};
  SteadyWatch watch(setup.steady->change);
  SteadyWatch::State state;
  if (holds(reader, watch_name, definition_of(setup, *setup.steady))) visit_steady_watch(state, Read{reader});
  watch.set_state(state);
  return watch;
}

std::vector<QuantityHistory> read_history(const CheckpointReader& reader, const Case& setup) {
  std::vector<QuantityHistory> history;
  for (const QuantitySpec& q : setup.quantities) {
    QuantityHistory& h = history.emplace_back(no_history);
    if (!holds(reader, history_name(q, 0), definition_of(q))) continue;
    for (std::size_t k = 0; k < h.size(); ++k) {
      const std::string name = history_name(q, k);
      if (reader.number(name) != no_history[k]) Read{reader}(name, h[k]);
    }
  }
  return history;
}

SeriesMeans read_means(const CheckpointReader& reader, const Case& setup) {
  SeriesMeans means;
  for (const ColumnsSpec& series : setup.output.series) means.emplace_back(series.columns.size());
  visit_means(setup, means, [&](const std::string& name, const std::string& definition, StepMean& mean) {
    if (!holds(reader, name, definition)) return;
    Read{reader}(name + ".sum", mean.sum);
    Read{reader}(name + ".count", mean.count, 0);
  });
  return means;
}

}  // namespace silt
