#pragma once
// The work of the program on a case: to run, resume, check and describe it.
#include <mpi.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace silt {

enum class Exit : int {
  done = 0,
  failed = 1,       // a file could not be written, or something nobody thought of
  bad_case = 2,     // or bad usage; nothing was started
  guard = 3,        // a value left its allowed range
  interrupted = 4,  // by a signal or a time limit; a checkpoint is there
};

struct RunOptions {
  std::filesystem::path directory;           // of the case
  std::optional<std::filesystem::path> out;  // else DIRECTORY/out
  std::vector<std::string> overrides;        // --set
  bool overwrite = false;
  double time_limit = 0;  // seconds of wall-clock time; 0: none
  int ranks = 0;          // that a run is estimated for; 0: as many as there are
  std::optional<std::filesystem::path>
      checkpoint;  // to resume from; else the newest in the folder of results
};

/// Collective. Prints on rank 0: progress to stdout, errors to stderr. The return value is the same on every
/// rank. If a rank fails alone, it says so and ends the whole program with MPI_Abort.
Exit run_case(const RunOptions&, MPI_Comm);
/// Collective. Goes on from a checkpoint, else as run_case.
Exit resume_case(const RunOptions&, MPI_Comm);

/// Reads and judges a case without running it; returns its derived table and its warnings. CaseError.
std::string examine_case(const RunOptions&);

/// Returns where the results go: the option, else DIRECTORY/out.
std::filesystem::path result_folder(const RunOptions&);

/// Returns the derived table of a case (a folder with a case.toml, or a .toml file) and a list of the results
/// in its folder `out`; of another folder the list alone. CaseError; std::runtime_error for a folder with
/// neither.
std::string describe_case(const std::filesystem::path&);

/// Starts MPI, unless somebody has; returns whether it did. Arguments as of MPI_Init, or none.
bool start_mpi(int* argc = nullptr, char*** argv = nullptr);

}  // namespace silt
