#pragma once
// When bodies at rest are held.

namespace silt::rigid {

/// A body whose surface moves no faster than `speed` for `steps` steps is held at rest until forces out of
/// balance would have given it twice that speed in as many, or something hits it.
struct SleepRule {
  double speed;  // lattice units
  int steps;
};

}  // namespace silt::rigid
