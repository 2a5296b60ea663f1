#include "coupler/results/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "coupler/case/case.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/results/check_state.hpp"
#include "coupler/results/flow_fields.hpp"
#include "parallel/together.hpp"

namespace silt::coupler {

namespace {

using adapters::CheckpointReader;
using adapters::CheckpointWriter;

// ---- numbers: one list serves writing and reading ----

template <class Balance, class Visit>
void visit_balance(Balance& b, Visit&& visit) {
  visit("initial_mass_deviation", b.mass_deviation);
  visit("initial_fluid_cells", b.fluid_cells);
  visit("initial_momentum_x", b.momentum[0]);
  visit("initial_momentum_y", b.momentum[1]);
  visit("initial_momentum_z", b.momentum[2]);
  visit("initial_momentum_scale", b.momentum_scale);
}

struct Write {
  CheckpointWriter& writer;
  void operator()(const char* name, std::uint64_t x) const { writer.set(name, static_cast<std::int64_t>(x)); }
  void operator()(const char* name, double x) const { writer.set(name, x); }
  void operator()(const CounterName& name, auto x) const { (*this)(name.checkpoint, x); }
};

constexpr std::int64_t most = std::int64_t{1} << 62;  // of what is counted: no later step overflows it
constexpr std::int64_t last_step = std::int64_t{1} << 53;

std::int64_t read_integer(const CheckpointReader& reader, const std::string& name, std::int64_t low,
                          std::int64_t high) {
  const std::int64_t x = reader.integer(name);
  if (x < low || x > high)
    reader.refuse(fmt::format("/state/{} is {}, and must be from {} to {}", name, x, low, high));
  return x;
}

double read_number(const CheckpointReader& reader, const std::string& name, double low) {
  const double x = reader.number(name);
  if (!(x >= low && x < std::numeric_limits<double>::infinity()))
    reader.refuse(fmt::format("/state/{} is {}, and must be a number from {} on", name, x, low));
  return x;
}
double read_number(const CheckpointReader& reader, const std::string& name) {
  return read_number(reader, name, std::numeric_limits<double>::lowest());
}

struct Read {
  const CheckpointReader& reader;
  void operator()(const char* name, double& x) const { x = read_number(reader, name); }
  void operator()(const CounterName& name, std::uint64_t& x) const {
    x = static_cast<std::uint64_t>(read_integer(reader, name.checkpoint, 0, most));
  }
  void operator()(const CounterName& name, double& x) const { x = read_number(reader, name.checkpoint, 0); }
};

/// 128 bits as two numbers of 64.
void write_sum(CheckpointWriter& writer, const std::string& name, rigid::FixedSum sum) {
  writer.set(name + ".low", static_cast<std::int64_t>(sum));
  writer.set(name + ".high", static_cast<std::int64_t>(sum >> 64));
}
rigid::FixedSum read_sum(const CheckpointReader& reader, const std::string& name) {
  const auto low = static_cast<std::uint64_t>(reader.integer(name + ".low"));
  return (rigid::FixedSum(read_integer(reader, name + ".high", -(most / 2), most / 2)) << 64) | low;
}

constexpr const char* brought_names[3] = {"momentum_brought_x", "momentum_brought_y", "momentum_brought_z"};

std::string history_name(const QuantitySpec& q, std::size_t k) {
  return fmt::format("quantity.{}#{}", q.name, k);
}

// ---- the watch on what becomes steady ----

void write_steady_watch(CheckpointWriter& writer, const SteadySpec& spec, const SteadyWatch::State& state) {
  writer.set("steady.quantity", spec.quantity);
  writer.set("steady.change", spec.change);
  writer.set("steady.every", spec.every);
  writer.set("steady.looks", state.looks);
  writer.set("steady.value", state.value);
  writer.set("steady.last_change", state.last_change);
  writer.set("steady.within", state.within);
}

/// One that began with another rule has seen nothing.
bool has_watch_of(const CheckpointReader& reader, const SteadySpec& spec) {
  return reader.has("steady.quantity") && reader.text("steady.quantity") == spec.quantity &&
         reader.number("steady.change") == spec.change && reader.integer("steady.every") == spec.every;
}

// ---- populations ----

/// Calls visit(local cells, offset in the block's cells) for the planes of a block.
template <class Visit>
void for_planes(const lbm::CellBox& block, Visit&& visit) {
  lbm::CellBox plane{{}, {block.size.x, block.size.y, 1}};
  for (; plane.lower.z < block.size.z; ++plane.lower.z) visit(plane, plane.lower.z * plane.cells());
}

template <class T>
void write_populations(CheckpointWriter& writer, const Case& scene, const FluidFields& fields) {
  std::vector<double> g;
  writer.cells<T>("populations", scene.cells, lbm::directions, boxes_of(fields),
                  [&](int q, std::size_t b, T* out) {
                    for_planes(fields.block(int(b)), [&](const lbm::CellBox& plane, std::int64_t first) {
                      g.resize(std::size_t(plane.cells()));
                      fields.read(int(b), plane, q, g.data());
                      std::transform(g.begin(), g.end(), out + first, [](double x) { return T(x); });
                    });
                  });
}

template <class T>
void read_populations(const CheckpointReader& reader, FluidFields& fields) {
  std::vector<double> g;
  reader.cells<T>("populations", boxes_of(fields), [&](int q, std::size_t b, const T* in) {
    const lbm::CellBox& block = fields.block(int(b));
    for_planes(block, [&](const lbm::CellBox& plane, std::int64_t first) {
      g.assign(in + first, in + first + plane.cells());
      for (std::size_t n = 0; n < g.size(); ++n) {
        if (std::abs(g[n]) <= largest_population) continue;
        const lbm::Int3 at =
            block.lower + plane.lower + lbm::Int3{int(n) % block.size.x, int(n) / block.size.x, 0};
        reader.refuse(fmt::format("/cells/populations, population {} of the cell [{}, {}, {}]: it is {}", q,
                                  at.x, at.y, at.z, in[first + std::int64_t(n)]));
      }
      fields.write(int(b), plane, q, g.data());
    });
  });
}

void write_bodies(CheckpointWriter& writer, const rigid::BodySet& bodies) {
  using Impulses = std::vector<rigid::StoredImpulse>;
  writer.bodies({bodies.owned, [&](std::size_t row) { return bodies.record(row); },
                 [&](std::size_t row) -> const Impulses& { return bodies.stored_impulses[row]; }},
                column::saved);
}

// ---- the case ----

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

}  // namespace

namespace {

void write_state(const Simulation& simulation, const Quantities& quantities,
                 const std::filesystem::path& path, const adapters::Provenance& provenance,
                 const std::optional<SteadyWatch>& steady) {
  const Case& scene = simulation.setup();
  const Flow* flow = simulation.scene().flow.get();
  const RunCounters counters = simulation.counters();
  const auto history = quantities.history(simulation);

  CheckpointWriter writer(simulation.scene().comm, path, provenance);
  writer.set("step", simulation.steps_done());
  writer.set("time", static_cast<double>(simulation.steps_done()) * scene.units.time_step);
  writer.set("overrides", joined_lines(scene.overrides));
  writer.set("files", joined_lines(scene.files));
  visit_counters(counters, Write{writer});
  visit_balance(simulation.initial_balance(), Write{writer});
  writer.set("next_id", static_cast<std::int64_t>(simulation.next_id()));
  const rigid::FixedVec3 brought = simulation.momentum_brought();
  for (int d = 0; d < 3; ++d) write_sum(writer, brought_names[d], brought.q[d]);
  writer.set("fluid_speed", simulation.fluid_speed());
  for (std::size_t i = 0; i < history.size(); ++i)
    for (std::size_t k = 0; k < history[i].size(); ++k)
      writer.set(history_name(scene.quantities[i], k), history[i][k]);
  if (steady) write_steady_watch(writer, *scene.steady, steady->state());
  if (flow) {
    const MassCorrectionState& correction = flow->account().mass_correction();
    write_sum(writer, "mass_correction.surplus", correction.surplus);
    writer.set("mass_correction.fluid_cells", correction.fluid_cells);
    write_sum(writer, "mass_correction.link_gain", correction.link_gain);
    if (scene.fluid->precision == Precision::double_)
      write_populations<double>(writer, scene, flow->fields());
    else
      write_populations<float>(writer, scene, flow->fields());
  }
  write_bodies(writer, simulation.bodies());
  const auto folder = path.parent_path();
  writer.commit(scene.output.keep_checkpoints,
                {folder / "bodies.h5", folder / "series.csv", folder / "departures.csv"});
}

}  // namespace

std::filesystem::path write_checkpoint(const Simulation& simulation, const Quantities& quantities,
                                       const std::filesystem::path& folder,
                                       const adapters::Provenance& provenance,
                                       const std::optional<SteadyWatch>& steady) {
  const auto path = adapters::checkpoint_path(folder, simulation.steps_done());
  parallel::naming(path.string(), [&] { write_state(simulation, quantities, path, provenance, steady); });
  return path;
}

std::filesystem::path write_stopped_state(const Simulation& simulation, const Quantities& quantities,
                                          const std::filesystem::path& folder,
                                          const adapters::Provenance& provenance,
                                          const std::optional<SteadyWatch>& steady) {
  const auto path = folder / fmt::format("stopped_{:012}.h5", simulation.steps_done());
  parallel::naming(path.string(), [&] { write_state(simulation, quantities, path, provenance, steady); });
  return path;
}

CaseOrigin read_origin(const CheckpointReader& reader) {
  return {reader.case_text(), split_lines(reader.text("overrides")), split_lines(reader.text("files"))};
}

SavedState read_state(const CheckpointReader& reader, const Case& scene) {
  SavedState state;
  state.step = read_integer(reader, "step", 0, last_step);
  const std::int64_t named = adapters::checkpoint_step(reader.path()).value_or(state.step);
  if (state.step != named)
    reader.refuse(fmt::format("it is of step {}, by its name of step {}", state.step, named));
  visit_counters(state.counters, Read{reader});
  visit_balance(state.initial, Read{reader});
  state.next_id = static_cast<rigid::BodyId>(read_integer(reader, "next_id", 1, most));
  for (int d = 0; d < 3; ++d) state.momentum_brought.q[d] = read_sum(reader, brought_names[d]);
  state.fluid_speed = read_number(reader, "fluid_speed", 0);
  auto bodies = reader.bodies(column::saved);
  try {
    parallel::together(reader.comm(), [&] { require_possible(scene, bodies, state.next_id); });
  } catch (const std::runtime_error& error) {  // on every rank
    reader.refuse(error.what());
  }
  state.bodies = {std::move(bodies.records), std::move(bodies.impulses)};
  if (!scene.fluid) return state;
  const std::int64_t cells = std::int64_t{1} * scene.cells[0] * scene.cells[1] * scene.cells[2];
  state.mass_correction = {read_sum(reader, "mass_correction.surplus"),
                           read_integer(reader, "mass_correction.fluid_cells", 0, cells),
                           read_sum(reader, "mass_correction.link_gain")};
  if (reader.lattice("populations") != scene.cells || reader.components("populations") != lbm::directions)
    reader.refuse("its populations are of another lattice than the case's");
  const bool is_double = scene.fluid->precision == Precision::double_;
  state.set_populations = [&reader, is_double](FluidFields& fields) {
    is_double ? read_populations<double>(reader, fields) : read_populations<float>(reader, fields);
  };
  return state;
}

std::optional<SteadyWatch> read_steady_watch(const CheckpointReader& reader, const Case& scene) {
  if (!scene.steady) return {};
  SteadyWatch watch(scene.steady->change);
  if (has_watch_of(reader, *scene.steady))
    watch.set_state({read_integer(reader, "steady.looks", 0, last_step), read_number(reader, "steady.value"),
                     read_number(reader, "steady.last_change"),
                     read_integer(reader, "steady.within", 0, last_step)});
  return watch;
}

std::vector<QuantityHistory> read_history(const CheckpointReader& reader, const Case& scene) {
  std::vector<QuantityHistory> history;
  for (const QuantitySpec& q : scene.quantities) {
    QuantityHistory& h = history.emplace_back(no_history);
    for (std::size_t k = 0; k < h.size(); ++k) {
      const std::string name = history_name(q, k);
      if (reader.has(name) && reader.number(name) != no_history[k]) h[k] = read_number(reader, name);
    }
  }
  return history;
}

}  // namespace silt::coupler
