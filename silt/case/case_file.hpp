#pragma once
// Reads a case directory: case.toml and the files it names, and nothing outside the directory. One rank reads
// it, on the others it is at hand. `--set key.path=value` and `--unset key.path` change the tree of the file
// before it is read; what a case may change when its run goes on from a checkpoint is [run], [output] and
// [[quantities]], which do not act on the state.
#include <mpi.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "silt/case/case.hpp"
#include "silt/case/position_file.hpp"

namespace silt {

struct AttachedFile {
  std::string bytes;
  std::string fingerprint;     // "rock.stl: 684 bytes, XXH3 00112233aabbccdd"
  PositionContents positions;  // of a file of positions, whose bytes stay where they are
};

struct CaseSource {
  std::string file, text;                        // of case.toml: its path, for messages, and what it says
  std::map<std::string, AttachedFile> attached;  // by name, as far as they have been asked for

  std::filesystem::path directory() const { return std::filesystem::path(file).parent_path(); }
  /// Returns a file that the case names, beside it, read where it is not at hand; of positions, "cloud.csv"
  /// or "cloud.h5:/points", what there is to know without keeping them. std::invalid_argument says what is
  /// wrong with it.
  const AttachedFile& file_named(const std::string& name, bool of_positions = false);
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

/// Returns what a case file says after the overrides. Each sets one value, making tables on the way; a key
/// that says the same thing in another way (run.steps and run.time) is removed. "key.path=", without a value,
/// takes the key, table or entry of a list away; it must be there. Throws CaseError.
adapters::Node tree_of_case(const std::string& text, const std::string& file,
                            const std::vector<std::string>& overrides);

/// Return what is wrong with an argument of --set or --unset at first sight, or "". An empty value is more
/// often a variable of the shell that is not set than a key to be taken away.
std::string complaint_of_set(const std::string& argument);
std::string complaint_of_unset(const std::string& argument);

/// Returns the option that gives an override: "--set fluid.density=960", "--unset run.balance".
std::string override_text(const std::string& argument);

/// A checkpoint remembers this of the case it was written for: the members of Case of the same names.
struct CaseOrigin {
  std::string text;
  std::vector<std::string> overrides, files;
};

/// Reads the case that a run goes on with: what the source holds now, with the --set of the run that wrote
/// the checkpoint and then those given. CaseError, saying where, if anything else differs from what the run
/// began with.
Case case_to_resume(const CaseOrigin&, CaseSource&, const std::vector<std::string>& overrides);

/// Returns the options of the run that wrote the checkpoint which still hold: "--set run.steps=60 --unset
/// run.balance"; "" if there are none.
std::string earlier_options(const CaseOrigin&, const std::vector<std::string>& overrides);

/// A row as the page and `silt keys` have it.
struct KeyText {
  std::string name, type, unit, fallback, meaning;
};
/// The rows of a table of a case; path: "fluid", "output.fields".
struct KeySection {
  std::string path;
  std::vector<KeyText> keys;
};
/// Returns every key that a case may have, in the order of the page.
std::vector<KeySection> case_keys();

}  // namespace silt
