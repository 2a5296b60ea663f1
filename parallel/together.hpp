#pragma once
// Errors that all ranks throw alike. Work that may fail on one rank runs inside `together`, without
// collective calls of its own, so that no rank waits for one that has failed.
#include <mpi.h>

#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "parallel/communicator.hpp"

namespace silt::parallel {

/// An error of one rank, thrown on every rank.
struct CommonError : std::runtime_error {
  CommonError(int of, const std::string& text) : std::runtime_error(text), rank(of) {}
  int rank;
};

/// Returns the text of an error; for lack of memory with the limits to check.
std::string text_of(const std::exception&);

/// Converts an error; its rank is `mine` unless it is a CommonError.
CommonError common_error(const std::exception&, int mine);

/// Collective. Returns the text of the lowest rank with a nonempty one; "" if there is none.
std::string text_of_first(MPI_Comm, std::string);

/// Collective. Throws on every rank the error of the lowest rank that has one.
void throw_together(MPI_Comm, const CommonError* mine);

/// Collective. Runs `work` on this rank; if it threw on any rank, throws the error of the lowest such rank as
/// CommonError on every rank. `work` must not throw between two collective calls of its own.
template <class Work>
void together(MPI_Comm comm, Work&& work) {
  try {
    std::forward<Work>(work)();
  } catch (const std::exception& e) {
    const CommonError mine = common_error(e, rank_of(comm));
    return throw_together(comm, &mine);
  }
  throw_together(comm, nullptr);
}

/// The same for work on rank 0 only.
template <class Work>
void on_rank_0(MPI_Comm comm, Work&& work) {
  together(comm, [&] {
    if (rank_of(comm) == 0) work();
  });
}

/// Runs work that writes a file; adds the file's name to errors that lack it. The same on every rank.
template <class Work>
void with_file_name(const std::string& file, Work&& work) {
  try {
    std::forward<Work>(work)();
  } catch (const std::exception& e) {
    const std::string text = text_of(e);
    if (text.find(file) != std::string::npos) throw;
    const std::string named = file + ": cannot be written: " + text;
    if (const auto* common = dynamic_cast<const CommonError*>(&e)) throw CommonError(common->rank, named);
    throw std::runtime_error(named);
  }
}

/// Finds out whether all ranks have caught an error, or only some, for which the others wait forever.
class ErrorBarrier {
 public:
  explicit ErrorBarrier(MPI_Comm comm) : comm_(comm) {}  // collective
  /// Returns whether all ranks call this within some seconds. If not, the program must end.
  bool all_ranks_arrive();

 private:
  static constexpr double patience = 5;  // seconds
  OwnCommunicator comm_;                 // others may be in a collective call on another one
};

}  // namespace silt::parallel
