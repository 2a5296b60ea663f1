#include "coupler/exchange/reduce.hpp"

#include <algorithm>
#include <vector>

namespace silt::coupler {

Limbs limbs_of(rigid::FixedSum sum) {
  Limbs limbs;
  for (int k = 0; k < 4; ++k)
    limbs[k] = static_cast<std::uint32_t>(static_cast<unsigned __int128>(sum) >> (32 * k));
  return limbs;
}

rigid::FixedSum sum_of(const Limbs& limbs) {
  unsigned __int128 sum = 0;
  for (int k = 0; k < 4; ++k) sum += static_cast<unsigned __int128>(limbs[k]) << (32 * k);
  return static_cast<rigid::FixedSum>(sum);
}

void sum_over_ranks(MPI_Comm comm, std::span<rigid::FixedSum> sums) {
  std::vector<std::uint64_t> all;
  for (const rigid::FixedSum s : sums) {
    const Limbs limbs = limbs_of(s);
    all.insert(all.end(), limbs.begin(), limbs.end());
  }
  sum_over_ranks(comm, all);
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] = sum_of(Limbs{all[4 * i], all[4 * i + 1], all[4 * i + 2], all[4 * i + 3]});
}

void sum_over_ranks(MPI_Comm comm, std::span<std::uint64_t> sums) {
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_UINT64_T, MPI_SUM, comm);
}

void sum_over_ranks(MPI_Comm comm, std::span<rigid::ExactSum> sums) {
  constexpr int width = rigid::ExactSum::width;
  std::vector<std::int64_t> all;
  for (rigid::ExactSum& s : sums) {
    s.carry();
    all.insert(all.end(), s.parts().begin(), s.parts().end());
  }
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_INT64_T, MPI_SUM, comm);
  for (std::size_t i = 0; i < sums.size(); ++i)
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(width * i), width, sums[i].parts().begin());
}

void max_over_ranks(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_MAX, comm);
}

double max_over_ranks(MPI_Comm comm, double x) {
  max_over_ranks(comm, std::span(&x, 1));
  return x;
}

std::uint64_t least_over_ranks(MPI_Comm comm, std::uint64_t x) {
  MPI_Allreduce(MPI_IN_PLACE, &x, 1, MPI_UINT64_T, MPI_MIN, comm);
  return x;
}

std::uint64_t most_over_ranks(MPI_Comm comm, std::uint64_t x) {
  MPI_Allreduce(MPI_IN_PLACE, &x, 1, MPI_UINT64_T, MPI_MAX, comm);
  return x;
}

std::string text_of_one(MPI_Comm comm, std::string text) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const auto speaker = int(least_over_ranks(comm, std::uint64_t(text.empty() ? ranks : rank)));
  if (speaker == ranks) return "";
  std::uint64_t size = text.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, speaker, comm);
  text.resize(size);
  MPI_Bcast(text.data(), int(size), MPI_CHAR, speaker, comm);
  return text;
}

}  // namespace silt::coupler
