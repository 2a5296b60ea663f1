#include "adapters/hdf5/sparse_messages.hpp"

#include <algorithm>

#include "adapters/hdf5/together.hpp"

namespace silt::adapters::hdf5 {

SparseMessages::SparseMessages(MPI_Comm comm) {
  MPI_Comm_dup(comm, &comm_);
}

SparseMessages::~SparseMessages() {
  MPI_Comm_free(&comm_);
}

/// Adds what came from a rank to its message; what one rank sends comes in order.
void SparseMessages::take(std::vector<Message>& received, int rank, std::size_t bytes) {
  auto at = std::lower_bound(received.begin(), received.end(), rank,
                             [](const Message& m, int of) { return m.rank < of; });
  if (at == received.end() || at->rank != rank) at = received.insert(at, {rank, {}});
  at->bytes.insert(at->bytes.end(), piece_.begin(), piece_.begin() + static_cast<std::ptrdiff_t>(bytes));
}

/// Takes a piece, if one is there; without memory for it, it only remembers that.
void SparseMessages::receive(int tag, std::vector<Message>& received, std::exception_ptr& failed) {
  int found = 0, size = 0;
  MPI_Message matched;
  MPI_Status status;
  MPI_Improbe(MPI_ANY_SOURCE, tag, comm_, &found, &matched, &status);
  if (!found) return;
  MPI_Get_count(&status, MPI_BYTE, &size);
  MPI_Mrecv(piece_.data(), size, MPI_BYTE, &matched, MPI_STATUS_IGNORE);
  if (failed) return;  // the others are still sending
  try {
    take(received, status.MPI_SOURCE, static_cast<std::size_t>(size));
  } catch (...) {
    failed = std::current_exception();
  }
}

std::vector<SparseMessages::Message> SparseMessages::swap(const std::vector<Message>& sent) {
  std::vector<MPI_Request> requests;
  together(comm_, [&] {
    std::size_t pieces = 0;
    for (const Message& m : sent) pieces += m.bytes.size() / piece_bytes + 1;
    requests.reserve(pieces);
    piece_.resize(piece_bytes);
  });
  const int tag = round_++ % 2;  // a rank may be one round ahead of another, never two
  for (const Message& m : sent)
    for (std::size_t first = 0; first == 0 || first < m.bytes.size(); first += piece_bytes)
      MPI_Issend(m.bytes.data() + first, static_cast<int>(std::min(piece_bytes, m.bytes.size() - first)),
                 MPI_BYTE, m.rank, tag, comm_, &requests.emplace_back());
  std::vector<Message> received;
  std::exception_ptr failed;
  MPI_Request barrier = MPI_REQUEST_NULL;
  for (int taken = 0; !taken;) {
    receive(tag, received, failed);
    MPI_Testall(static_cast<int>(requests.size()), requests.data(), &taken, MPI_STATUSES_IGNORE);
  }
  MPI_Ibarrier(comm_, &barrier);
  for (int done = 0; !done;) {
    receive(tag, received, failed);
    MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
  }
  together(comm_, [&] {
    if (failed) std::rethrow_exception(failed);
  });
  return received;
}

}  // namespace silt::adapters::hdf5
