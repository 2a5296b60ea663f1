#pragma once
// The version of this program, and the provenance of a run's files.
#include <string>

#include "adapters/hdf5/result_file.hpp"

namespace silt {

struct Case;

/// Returns version, commit, compiler, flags, and libraries with their versions.
const adapters::Provenance& build_info();

/// Returns the provenance of files of a run that starts now.
adapters::Provenance provenance_of(const Case&, int ranks, const std::string& backend);

}  // namespace silt
