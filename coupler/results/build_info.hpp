#pragma once
// What this program was built from.
#include <string>

#include "adapters/hdf5/provenance.hpp"

namespace silt::coupler {

struct Case;

struct BuildInfo {
  std::string version, commit, compiler, flags;
  std::string libraries;  // with their versions
};
const BuildInfo& build_info();

/// Returns where the files of a run that starts now come from.
adapters::Provenance provenance_of(const Case&, int ranks, const std::string& backend);

}  // namespace silt::coupler
