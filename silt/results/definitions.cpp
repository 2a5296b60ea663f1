#include "silt/results/definitions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "silt/results/quantity_computation.hpp"

namespace silt {

using adapters::CheckpointReader;

namespace {

const QuantitySpec& quantity_named(const Case& setup, const std::string& name) {
  return *std::ranges::find(setup.quantities, name, &QuantitySpec::name);
}

std::string point_text(const rigid::Vec3& x) {
  return fmt::format("({}, {}, {})", x[0], x[1], x[2]);
}

/// Returns whether the checkpoint has data of a quantity with any definition.
bool has_history(const CheckpointReader& reader, const QuantitySpec& q) {
  const std::string name = history_name(q, 0);
  return reader.has(name) && reader.number(name) != not_yet;
}

/// Returns a warning if a quantity of the whole run restarts, or "".
std::string text_of_anew(const CheckpointReader& reader, const QuantitySpec& q, std::int64_t step) {
  const Computation& computation = computation_of(q.type);
  if (!(computation.gathers() || q.over) || holds(reader, history_name(q, 0), definition_of(q))) return "";
  const bool is_instant = quantity_type(q.type).takes(QuantityType::instant);
  if (is_instant && q.time < double(step) + 0.5)
    return fmt::format("has its time before step {}, where the run resumes, and no value in the checkpoint",
                       step);
  if (is_instant) return "";
  if (has_history(reader, q))
    return "has another definition than the result of this name in the checkpoint, and starts again";
  if ((q.over ? q.over->from : q.time) > double(step)) return "";
  return fmt::format("is not in the checkpoint; it starts at step {}, where the run resumes", step);
}

/// Returns the same for a series, whose next row may have begun before the step.
std::string text_of_anew(const CheckpointReader& reader, const Case& setup, const ColumnsSpec& series,
                         std::int64_t step) {
  if (step % series.every == 0 || !series.takes(step)) return "";
  std::string columns;
  for (std::size_t k = 0; k < series.columns.size(); ++k)
    if (!holds(reader, mean_name(series, k), definition_of(setup, series, k)))
      columns += (columns.empty() ? "'" : ", '") + series.columns[k] + "'";
  if (columns.empty()) return "";
  return fmt::format(
      "has means that begin before step {}, where the run resumes, and those of {} are not in the "
      "checkpoint; the next row is of the steps from there on",
      step, columns);
}

std::string text_of_anew(const CheckpointReader& reader, const MeanSpec& mean, std::int64_t step) {
  if (holds(reader, flow_mean_name, definition_of(mean))) return "";
  if (reader.has(definition_name(flow_mean_name)))
    return fmt::format("takes other samples than those in the checkpoint; they begin anew at step {}", step);
  if (mean.from > double(step)) return "";
  return fmt::format("has no samples in the checkpoint; they start at step {}, where the run resumes", step);
}

}  // namespace

std::string history_name(const QuantitySpec& q, std::size_t k) {
  return fmt::format("quantity.{}#{}", q.name, k);
}

std::string mean_name(const ColumnsSpec& series, std::size_t column) {
  return fmt::format("{}.{}.{}#{}", series.name, series.every, series.mean_of, series.columns[column]);
}

std::string definition_name(const std::string& of) {
  return of + ".of";
}

std::string definition_of(const QuantitySpec& q) {
  const auto& [name, type, bearer, kind, axis, time, height, second_height, over, side, wall, component,
               centre, box] = q;
  std::string more;
  if (second_height != 0) more += fmt::format(", and {}", second_height);
  if (over)
    more += fmt::format(", {} over {} to {}", over->deviation ? "deviation" : "mean", over->from, over->to);
  return fmt::format(
      "{}: bearer {}, kind {}, axis {}, time {}, height {}, side {}, wall {}, component {}, centre {}, box "
      "{} "
      "to {}{}",
      type, int(bearer), kind, axis, time, height, side, wall, component, point_text(centre),
      point_text(box.lower), point_text(box.upper), more);
}

std::string definition_of(const Case& setup, const ColumnsSpec& series, std::size_t column) {
  QuantitySpec in_step = quantity_named(setup, series.columns[column]);
  in_step.time = 0, in_step.over = {};  // a row has what it is in a step, from the first on
  return definition_of(in_step);
}

std::string definition_of(const Case& setup, const SteadySpec& steady) {
  return fmt::format("{}, to {} every {} steps", definition_of(quantity_named(setup, steady.quantity)),
                     steady.change, steady.every);
}

std::string definition_of(const MeanSpec& mean) {
  return fmt::format("from {}, every {} steps", mean.from, mean.every);
}

bool holds(const CheckpointReader& reader, const std::string& name, const std::string& definition) {
  const std::string of = definition_name(name);
  return reader.has(of) && reader.text(of) == definition;
}

std::vector<Diagnostic> begun_anew(const CheckpointReader& reader, const Case& setup) {
  std::vector<Diagnostic> warnings;
  const auto warn = [&](const std::string& path, const std::string& name, const std::string& text) {
    if (!text.empty())
      warnings.push_back({Diagnostic::Severity::warning, setup.place(path), path + name + ' ' + text});
  };
  const std::int64_t step = reader.integer("step");
  for (std::size_t i = 0; i < setup.quantities.size(); ++i) {
    const QuantitySpec& q = setup.quantities[i];
    warn(fmt::format("quantities[{}]", i), fmt::format(" ('{}')", q.name), text_of_anew(reader, q, step));
  }
  for (std::size_t s = 0; s < setup.output.series.size(); ++s)
    warn(fmt::format("output.series[{}]", s), "", text_of_anew(reader, setup, setup.output.series[s], step));
  if (setup.output.mean) warn("output.mean", "", text_of_anew(reader, *setup.output.mean, step));
  if (setup.steady && reader.has(definition_name(watch_name)) &&
      !holds(reader, watch_name, definition_of(setup, *setup.steady)))
    warn("run.steady", "",
         fmt::format("watches something else than before; its looks begin anew at step {}", step));
  return warnings;
}

}  // namespace silt
