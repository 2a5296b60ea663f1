#include "adapters/hdf5/together.hpp"

#include <new>

namespace silt::adapters {

std::string text_of(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error))
    return "no memory is left (if the machine has some, look at ulimit -v)";
  return error.what();
}

CommonError common_error(const std::exception& error, int mine) {
  const auto* common = dynamic_cast<const CommonError*>(&error);
  return {common ? common->rank : mine, text_of(error)};
}

void throw_together(MPI_Comm comm, const CommonError* mine) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  int first = mine ? rank : ranks;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == ranks) return;
  std::string text = mine ? mine->what() : "";
  int of[2] = {mine ? mine->rank : 0, static_cast<int>(text.size())};
  MPI_Bcast(of, 2, MPI_INT, first, comm);
  text.resize(of[1]);
  MPI_Bcast(text.data(), of[1], MPI_CHAR, first, comm);
  throw CommonError(of[0], text);
}

}  // namespace silt::adapters
