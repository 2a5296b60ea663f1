#pragma once
// What the parts of a step cost, in tenths of a fluid cell in single precision: whole numbers, so that sums,
// and the cuts that follow from them, are the same on every machine. Ratios measured on one core
// (tests/bench/README.md): `scripts/bench fluid` and `links` for cells and links, `coupled` for mapping,
// `bed` and `dry` for bodies.
#include <cstdint>

namespace silt::coupler {

struct Case;

struct WorkCosts {
  explicit WorkCosts(const Case&);

  std::int64_t cell = 0;     // 0 without a fluid
  std::int64_t link = 0;     // cut link
  std::int64_t mapping = 0;  // of a cut link, each time its body is mapped
  std::int64_t body = 0;     // that moves, all sub-steps
  std::int64_t impulse = 0;  // remembered by a body, all sub-steps; a contact is remembered by both bodies
};

}  // namespace silt::coupler
