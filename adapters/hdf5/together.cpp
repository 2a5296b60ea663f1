#include "adapters/hdf5/together.hpp"

#include <stdexcept>

namespace silt::adapters {

void throw_together(MPI_Comm comm, bool failed, const std::string& error) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const int mine = failed ? rank : ranks;
  int first = ranks;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == ranks) return;
  int length = static_cast<int>(error.size());
  MPI_Bcast(&length, 1, MPI_INT, first, comm);
  std::string text = error;
  text.resize(length);
  MPI_Bcast(text.data(), length, MPI_CHAR, first, comm);
  throw std::runtime_error(text);
}

}  // namespace silt::adapters
