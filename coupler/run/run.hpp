#pragma once
// A run from its case directory to its report: steps, outputs, checkpoints, guards, and how it ends.
#include <mpi.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace silt::coupler {

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

/// Collective. Prints on rank 0: what goes on to stdout, what went wrong to stderr. The return value is the
/// same on every rank. If a rank fails alone, it says so and ends the whole program with MPI_Abort.
Exit run_case(const RunOptions&, MPI_Comm);
/// Collective. Goes on from a checkpoint, else as run_case.
Exit resume_case(const RunOptions&, MPI_Comm);

}  // namespace silt::coupler
