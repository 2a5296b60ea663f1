#pragma once
// What a run writes and when: the table [output] of a case.
#include <cstdint>
#include <vector>

#include "coupler/case/name_table.hpp"

namespace silt::coupler {

struct SeriesSpec {  // 0: never
  std::int64_t every = 0;
};

enum class Field { velocity, density };
inline constexpr auto field_names = names_of<Field>("velocity", "density");

struct OutputSpec {
  SeriesSpec fields, bodies, checkpoint, report;
  std::vector<Field> quantities;  // of the fields
  int keep_checkpoints = 2;
};

}  // namespace silt::coupler
