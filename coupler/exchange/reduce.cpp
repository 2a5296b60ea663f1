#include "coupler/exchange/reduce.hpp"

#include <vector>

namespace silt::coupler {

/// A 128-bit sum goes as four limbs of 32 bits, each with room for the carries of 2^32 ranks.
void sum_over_ranks(MPI_Comm comm, std::span<rigid::FixedSum> sums) {
  std::vector<std::uint64_t> limbs;
  for (const rigid::FixedSum s : sums)
    for (int k = 0; k < 4; ++k)
      limbs.push_back(static_cast<std::uint32_t>(static_cast<unsigned __int128>(s) >> (32 * k)));
  sum_over_ranks(comm, limbs);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    unsigned __int128 sum = 0;
    for (int k = 0; k < 4; ++k) sum += static_cast<unsigned __int128>(limbs[4 * i + k]) << (32 * k);
    sums[i] = static_cast<rigid::FixedSum>(sum);
  }
}

void sum_over_ranks(MPI_Comm comm, std::span<std::uint64_t> sums) {
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_UINT64_T, MPI_SUM, comm);
}

void max_over_ranks(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, comm);
}

double max_over_ranks(MPI_Comm comm, double x) {
  max_over_ranks(comm, std::span(&x, 1));
  return x;
}

}  // namespace silt::coupler
