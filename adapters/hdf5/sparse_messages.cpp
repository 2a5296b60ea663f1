#include "adapters/hdf5/sparse_messages.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "adapters/hdf5/together.hpp"

namespace silt::adapters::hdf5 {

SparseMessages::SparseMessages(MPI_Comm comm) {
  MPI_Comm_dup(comm, &comm_);
}

SparseMessages::~SparseMessages() {
  MPI_Comm_free(&comm_);
}

namespace {

/// Takes a message, if one is there.
bool receive(MPI_Comm comm, int tag, std::vector<SparseMessages::Message>& received) {
  int found = 0, size = 0;
  MPI_Message matched;
  MPI_Status status;
  MPI_Improbe(MPI_ANY_SOURCE, tag, comm, &found, &matched, &status);
  if (!found) return false;
  MPI_Get_count(&status, MPI_BYTE, &size);
  auto& m = received.emplace_back(
      SparseMessages::Message{status.MPI_SOURCE, std::vector<std::byte>(static_cast<std::size_t>(size))});
  MPI_Mrecv(m.bytes.data(), size, MPI_BYTE, &matched, MPI_STATUS_IGNORE);
  return true;
}

}  // namespace

std::vector<SparseMessages::Message> SparseMessages::swap(const std::vector<Message>& sent) {
  together(comm_, [&] {
    for (const Message& m : sent)
      if (m.bytes.size() > std::size_t{std::numeric_limits<int>::max()})
        throw std::length_error("a message of " + std::to_string(m.bytes.size()) +
                                " bytes is too long: use more ranks");
  });
  const int tag = round_++ % 2;  // a rank may be one round ahead of another, never two
  std::vector<MPI_Request> requests(sent.size());
  for (std::size_t k = 0; k < sent.size(); ++k)
    MPI_Issend(sent[k].bytes.data(), static_cast<int>(sent[k].bytes.size()), MPI_BYTE, sent[k].rank, tag,
               comm_, &requests[k]);
  std::vector<Message> received;
  MPI_Request barrier = MPI_REQUEST_NULL;
  for (int taken = 0; !taken;) {
    receive(comm_, tag, received);
    MPI_Testall(static_cast<int>(requests.size()), requests.data(), &taken, MPI_STATUSES_IGNORE);
  }
  MPI_Ibarrier(comm_, &barrier);
  for (int done = 0; !done;) {
    receive(comm_, tag, received);
    MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
  }
  std::sort(received.begin(), received.end(),
            [](const Message& a, const Message& b) { return a.rank < b.rank; });
  return received;
}

}  // namespace silt::adapters::hdf5
