#pragma once
// Runs, resumes, checks and describes cases for the program.
#include <mpi.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace silt {

enum class Exit : int {
  done = 0,
  failed = 1,       // a file could not be written, or an unforeseen error
  bad_case = 2,     // or wrong usage; nothing was started
  guard = 3,        // a value left its allowed range
  interrupted = 4,  // by a signal or time limit; left a checkpoint
};

struct RunOptions {
  std::filesystem::path directory;           // of the case
  std::optional<std::filesystem::path> out;  // else DIRECTORY/out
  std::vector<std::string> overrides;        // --set
  bool overwrite = false;
  double time_limit = 0;                            // seconds of wall-clock time; 0: none
  int ranks = 0;                                    // for the estimate of a run; 0: the present number
  std::optional<std::filesystem::path> checkpoint;  // to resume; else the newest in the folder of results
};

/// Runs a case; prints progress to stdout and errors to stderr on rank 0. Returns the same on every rank. A
/// rank that fails alone reports it and ends all ranks with MPI_Abort. Collective.
Exit run_case(const RunOptions&, MPI_Comm);
/// Continues from a checkpoint, otherwise like run_case. Collective.
Exit resume_case(const RunOptions&, MPI_Comm);

/// Reads and checks a case without running it; returns its derived table and warnings. Throws CaseError.
std::string examine_case(const RunOptions&);

/// Returns the folder for results: the option, or else DIRECTORY/out.
std::filesystem::path result_folder(const RunOptions&);

/// Returns what names the case and its folder of results on a command line, quoted for a shell.
std::string arguments_of(const RunOptions&);

/// Returns the derived table of a case (a folder with a case.toml, or a .toml file) and a list of the results
/// in its folder `out`, or, for another folder, the list alone. Throws CaseError or std::runtime_error.
std::string describe_case(const std::filesystem::path&);

/// Starts MPI unless it is running; returns whether it did. Arguments as for MPI_Init, or none.
bool start_mpi(int* argc = nullptr, char*** argv = nullptr);

}  // namespace silt
