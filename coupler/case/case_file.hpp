#pragma once
// Reads a case directory: case.toml and the files it names, and nothing outside the directory. One rank reads
// it, on the others it is at hand.
#include <mpi.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "coupler/case/case.hpp"
#include "coupler/case/position_file.hpp"

namespace silt::coupler {

struct AttachedFile {
  std::string bytes;
  std::string fingerprint;     // "rock.stl: 684 bytes, XXH3 00112233aabbccdd"
  PositionContents positions;  // of a file of positions, whose bytes stay where they are
};

struct CaseSource {
  std::string file, text;                        // of case.toml: its path, for messages, and what it says
  std::map<std::string, AttachedFile> attached;  // by name, as far as they have been asked for

  std::filesystem::path directory() const { return std::filesystem::path(file).parent_path(); }
  /// Returns a file that the case names, beside it, read where it is not at hand. std::invalid_argument says
  /// what is wrong with it.
  const AttachedFile& file_named(const std::string& name);
  /// Returns what there is to know of positions, "cloud.csv" or "cloud.h5:/points", without keeping them;
  /// errors alike.
  const AttachedFile& positions_named(const std::string& name);
};

/// Reads case.toml of a directory, or the .toml file itself. CaseError.
CaseSource read_source(const std::filesystem::path& directory);

/// Collective. Hands what rank 0 has to all.
void broadcast(MPI_Comm, CaseSource&);

/// Reads `directory`/case.toml (or the file itself, if a .toml file is given) and converts everything to
/// lattice units. `overrides` are the values of `--set`: "key.path=value", the value in TOML, strings also
/// without quotes; list entries as in bodies[0].density. Throws CaseError with everything that is wrong:
/// syntax, unknown keys, types, ranges. Whether the scene makes sense is for check_case.
Case read_case(const std::filesystem::path& directory, const std::vector<std::string>& overrides = {});

/// Reads from a source as read_case does from a directory; the files that it had to read are in it then.
Case read_case(CaseSource&, const std::vector<std::string>& overrides = {});

/// Reads text at hand as read_case does a file; `file` labels the messages.
Case read_case_text(const std::string& text, const std::string& file,
                    const std::vector<std::string>& overrides = {});

}  // namespace silt::coupler
