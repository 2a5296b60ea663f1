#pragma once
// Whether an error is every rank's or this one's alone.
#include <mpi.h>

namespace silt::coupler {

/// Ranks that have caught an error look whether all others come to the same place: those that wait for this
/// one somewhere else never do.
class Reunion {
 public:
  explicit Reunion(MPI_Comm);  // collective
  ~Reunion();
  Reunion(const Reunion&) = delete;
  Reunion& operator=(const Reunion&) = delete;

  /// Returns whether all ranks call this within some seconds. If not, nothing is left to do but to end the
  /// program.
  bool all_here();

 private:
  static constexpr double patience = 5;  // seconds
  MPI_Comm comm_ = MPI_COMM_NULL;        // its own: others may wait in a collective call of another
};

}  // namespace silt::coupler
