#pragma once
// The table [output] of a case: what a run writes, and when.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coupler/spec/name_table.hpp"
#include "rigid/math/types.hpp"

namespace silt {

struct SeriesSpec {  // 0: never
  std::int64_t every = 0;
};

enum class Field { velocity, density, pressure, shear_rate, temperature, body_id, vorticity, solid };
inline constexpr auto field_names = coupler::names_of<Field>("velocity", "density", "pressure", "shear-rate",
                                                             "temperature", "body-id", "vorticity", "solid");

constexpr int numbers_of(Field field) {
  return field == Field::velocity || field == Field::vorticity ? 3 : 1;
}

/// Fields of the fluid in a box of cells, [lower, upper), with `solid` if the scene has solid cells.
struct FieldsSpec : SeriesSpec {
  std::string name = "fields";  // of the files
  std::vector<Field> quantities = {Field::velocity, Field::density};
  std::array<int, 3> lower{}, upper{};
  bool double_precision = false;
};

/// Values of [[quantities]] over time, one row of a CSV file every `every` steps.
struct ColumnsSpec : SeriesSpec {
  std::string name;                  // of the file
  std::vector<std::string> columns;  // names of quantities
  std::int64_t mean_of = 1;          // steps before a row, with its own, that it averages

  /// Returns whether a row includes this step.
  bool takes(std::int64_t step) const { return (step + mean_of - 1) % every < mean_of; }
};

/// Fields of the fluid at points, rows of a CSV file every `every` steps.
struct ProbesSpec : SeriesSpec {
  std::string name;  // of the file
  std::vector<Field> quantities = {Field::velocity};
  std::vector<rigid::Vec3> points;
};

/// Time averages of the fluid.
struct MeanSpec {
  double from = 0;         // in steps
  std::int64_t every = 1;  // steps between two samples
};

struct OutputSpec {
  FieldsSpec fields;  // of the whole domain
  std::vector<FieldsSpec> slices;
  std::vector<ColumnsSpec> series;
  std::vector<ProbesSpec> probes;
  std::optional<MeanSpec> mean;
  SeriesSpec bodies, checkpoint, report;
  bool body_contacts = false;  // write contact loads with the bodies
  int keep_checkpoints = 2;
};

}  // namespace silt
