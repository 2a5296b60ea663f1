#pragma once
// The origin of this program, and of the files of a run.
#include <string>

#include "adapters/hdf5/result_file.hpp"

namespace silt {

struct Case;

/// Returns version, commit, compiler, flags, and libraries with their versions.
const adapters::Provenance& build_info();

/// Returns the origin of the files of a run that starts now.
adapters::Provenance provenance_of(const Case&, int ranks, const std::string& backend);

}  // namespace silt
