#pragma once
// Errors that all ranks see alike. What may fail on one rank is done inside `together` and without a
// collective call there; then no rank waits for another that has given up.
#include <mpi.h>

#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "parallel/communicator.hpp"

namespace silt::parallel {

/// An error of one rank, as every rank throws it.
struct CommonError : std::runtime_error {
  CommonError(int of, const std::string& text) : std::runtime_error(text), rank(of) {}
  int rank;
};

/// Returns the text of an error; a lack of memory also names the limits to look at.
std::string text_of(const std::exception&);

/// Returns an error's text and rank, `mine` for an error without a rank.
CommonError common_error(const std::exception&, int mine);

/// Collective. Returns the text of the first rank that has one; "" if none has.
std::string text_of_first(MPI_Comm, std::string);

/// Throws on every rank (collective) the error of the lowest rank that hands one over.
void throw_together(MPI_Comm, const CommonError* mine);

/// Runs `work` on this rank (collective); if it threw on any rank, every rank throws the error of the lowest
/// such rank as CommonError. `work` must not throw between two collective calls of its own.
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

/// Does the same as `together` for work that only rank 0 does.
template <class Work>
void on_rank_0(MPI_Comm comm, Work&& work) {
  together(comm, [&] {
    if (rank_of(comm) == 0) work();
  });
}

/// Runs work that writes a file, the same on every rank: an error that does not name the file gets its name.
template <class Work>
void naming(const std::string& file, Work&& work) {
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

/// Ranks that have caught an error look whether it is every rank's or this one's alone: whether all others
/// come to the same place. Those that wait for this one somewhere else never do.
class Reunion {
 public:
  explicit Reunion(MPI_Comm comm) : comm_(comm) {}  // collective
  /// Returns whether all ranks call this within some seconds. If not, the program has to end.
  bool all_here();

 private:
  static constexpr double patience = 5;  // seconds
  OwnCommunicator comm_;                 // others may wait in a collective call of another
};

}  // namespace silt::parallel
