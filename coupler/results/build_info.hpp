#pragma once
// What this program was built from, and where the files of a run come from.
#include <string>

#include "adapters/hdf5/result_file.hpp"

namespace silt::coupler {

struct Case;

/// Returns what the build knows of it: version, commit, compiler, flags, and libraries with their versions.
const adapters::Provenance& build_info();

/// Returns where the files of a run that starts now come from.
adapters::Provenance provenance_of(const Case&, int ranks, const std::string& backend);

}  // namespace silt::coupler
