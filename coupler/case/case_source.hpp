#pragma once
// What a case is read from, case.toml and the files it names: read from its directory by one rank, at hand on
// the others.
#include <mpi.h>

#include <filesystem>
#include <map>
#include <string>

#include "coupler/case/attached_file.hpp"

namespace silt::coupler {

struct CaseSource {
  std::string file, text;                        // of case.toml: its path, for messages, and what it says
  std::map<std::string, AttachedFile> attached;  // by name, as far as they have been asked for

  std::filesystem::path directory() const { return std::filesystem::path(file).parent_path(); }
  /// Returns a file that the case names, read where it is not at hand; errors are those of read_attached.
  const AttachedFile& file_named(const std::string& name);
  /// Returns what there is to know of a file of positions; errors are those of look_at_positions.
  const AttachedFile& positions_named(const std::string& name);
};

/// Reads case.toml of a directory, or the .toml file itself. CaseError.
CaseSource read_source(const std::filesystem::path& directory);

/// Collective. Hands what rank 0 has to all.
void broadcast(MPI_Comm, CaseSource&);

}  // namespace silt::coupler
