#pragma once
// Reads a case directory: case.toml and the files it names, nothing outside the directory. One rank reads and
// broadcasts them. `--set key.path=value` and `--unset key.path` change the tree of the file before it is
// read. A run that continues from a checkpoint may change [run], [output] and [[quantities]], not the state.
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
  PositionContents positions;  // of a file of positions, whose bytes are not kept
};

struct CaseSource {
  std::string file, text;                        // path of case.toml for messages, and its content
  std::map<std::string, AttachedFile> attached;  // by name, those requested so far

  std::filesystem::path directory() const { return std::filesystem::path(file).parent_path(); }
  /// Returns a file that the case names, reading it if necessary; of positions ("cloud.csv" or
  /// "cloud.h5:/points") only a summary. Throws std::invalid_argument with its fault.
  const AttachedFile& file_named(const std::string& name, bool of_positions = false);
};

/// Reads case.toml of a directory, or a .toml file. Throws CaseError.
CaseSource read_source(const std::filesystem::path& directory);

/// Broadcasts the source of rank 0. Collective.
void broadcast(MPI_Comm, CaseSource&);

/// Reads `directory`/case.toml, or a .toml file, and converts it to lattice units. `overrides` are values of
/// `--set`: "key.path=value", with a value in TOML, strings also without quotes, and entries of lists as
/// bodies[0].density. Throws CaseError with all errors of syntax, keys, types, ranges; see check_case for
/// others.
Case read_case(const std::filesystem::path& directory, const std::vector<std::string>& overrides = {});

/// Reads a source in the same way; files read meanwhile are added to it.
Case read_case(CaseSource&, const std::vector<std::string>& overrides = {});

/// Returns the tree of a case file after the overrides. Each sets one value, creating tables, and removes an
/// alternative key (run.steps and run.time). "key.path=" without a value removes a key, table or entry, which
/// must exist. Throws CaseError.
adapters::Node tree_of_case(const std::string& text, const std::string& file,
                            const std::vector<std::string>& overrides);

/// Return the obvious fault of an argument of --set or --unset, or "". An empty value is usually a shell
/// variable that is not set, not the removal of a key.
std::string complaint_of_set(const std::string& argument);
std::string complaint_of_unset(const std::string& argument);

/// Returns the option of an override: "--set fluid.density=960", "--unset run.balance".
std::string override_text(const std::string& argument);

/// What a checkpoint stores of its case: the members of Case of the same names.
struct CaseOrigin {
  std::string text;
  std::vector<std::string> overrides, files;
};

/// Reads the case of a resumed run: the source with the --set of the run that wrote the checkpoint and then
/// those given. Throws CaseError with the place if anything else differs from the case at the start.
Case case_to_resume(const CaseOrigin&, CaseSource&, const std::vector<std::string>& overrides);

/// Returns the options of the earlier run that still hold, "--set run.steps=60 --unset run.balance", or "".
std::string earlier_options(const CaseOrigin&, const std::vector<std::string>& overrides);

/// A key as on the page and in `silt keys`.
struct KeyText {
  std::string name, type, unit, fallback, meaning;
};
/// The keys of a table of a case; path: "fluid", "output.fields".
struct KeySection {
  std::string path;
  std::vector<KeyText> keys;
};
/// Returns all keys of cases, in the order of the page.
std::vector<KeySection> case_keys();

}  // namespace silt
