#include "parallel/messages.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "parallel/counted.hpp"

namespace silt::parallel {

using counting::waiting;

namespace {
constexpr int partner_tag = 0;
/// A rank may be one round of unannounced messages ahead of another, never two: two tags distinguish them.
constexpr int first_unannounced_tag = 1;
/// Unannounced messages are sent in pieces of this size, for which the receiver always has a buffer.
constexpr std::size_t piece_bytes = 1 << 20;
}  // namespace

Messages::Message& Messages::message_of(Round& round, int rank) {
  const auto at = std::lower_bound(round.begin(), round.end(), rank,
                                   [](const Message& m, int of) { return m.rank < of; });
  if (at != round.end() && at->rank == rank) return *at;
  if (spare_.empty()) return *round.insert(at, {rank, {}});
  Message& added = *round.insert(at, std::move(spare_.back()));
  spare_.pop_back();
  added.rank = rank;
  added.bytes.clear();
  return added;
}

Bytes& Messages::to(int rank) {
  return message_of(sent_, rank).bytes;
}

void Messages::make_room() {
  spare_.reserve(spare_.size() + received_.size() + sent_.size());
  std::size_t pieces = 0;
  for (const Message& m : sent_) pieces += m.bytes.size() / piece_bytes + 1;
  requests_.reserve(pieces);
  piece_.resize(piece_bytes);
}

void Messages::begin_round() {
  for (Message& m : received_) spare_.push_back(std::move(m));
  received_.clear();
  requests_.clear();
}

void Messages::end_round() {
  for (Message& m : sent_) spare_.push_back(std::move(m));
  sent_.clear();
}

void Messages::send(const Message& m, std::size_t first, std::size_t bytes, int tag, bool synchronous) {
  counting::count_message(bytes);
  (synchronous ? MPI_Issend : MPI_Isend)(m.bytes.data() + first, int(bytes), MPI_BYTE, m.rank, tag, comm_,
                                         &requests_.emplace_back());
  ++messages_sent_;
  bytes_sent_ += bytes;
}

void Messages::exchange_with(std::span<const int> sources) {
  begin_round();
  for (const Message& m : sent_) {
    if (m.bytes.size() > std::numeric_limits<int>::max())
      throw std::length_error("a message of " + std::to_string(m.bytes.size()) + " bytes to rank " +
                              std::to_string(m.rank) + " is longer than MPI can send: use more ranks");
    send(m, 0, m.bytes.size(), partner_tag, false);
  }
  for (const int source : sources) {
    MPI_Message matched;
    MPI_Status status;
    waiting([&] { MPI_Mprobe(source, partner_tag, comm_, &matched, &status); });
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Bytes& bytes = message_of(received_, source).bytes;
    bytes.resize(size);
    waiting([&] { MPI_Mrecv(bytes.data(), size, MPI_BYTE, &matched, MPI_STATUS_IGNORE); });
  }
  waiting([&] { MPI_Waitall(int(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE); });
  end_round();
}

/// Receives a piece, if there is one; those of one rank arrive in order.
void Messages::receive_piece(int tag) {
  int found = 0, size = 0;
  MPI_Message matched;
  MPI_Status status;
  waiting([&] { MPI_Improbe(MPI_ANY_SOURCE, tag, comm_, &found, &matched, &status); });
  if (!found) return;
  MPI_Get_count(&status, MPI_BYTE, &size);
  waiting([&] { MPI_Mrecv(piece_.data(), size, MPI_BYTE, &matched, MPI_STATUS_IGNORE); });
  if (failed_) return;  // the other ranks are still sending
  try {
    Bytes& bytes = message_of(received_, status.MPI_SOURCE).bytes;
    bytes.insert(bytes.end(), piece_.begin(), piece_.begin() + size);
  } catch (...) {
    failed_ = std::current_exception();
  }
}

void Messages::exchange_sparse() {
  make_room();
  begin_round();
  failed_ = nullptr;
  const int tag = first_unannounced_tag + round_++ % 2;
  for (const Message& m : sent_)
    for (std::size_t first = 0; first == 0 || first < m.bytes.size(); first += piece_bytes)
      send(m, first, std::min(piece_bytes, m.bytes.size() - first), tag, true);
  for (int taken = 0; !taken;) {
    receive_piece(tag);
    waiting([&] { MPI_Testall(int(requests_.size()), requests_.data(), &taken, MPI_STATUSES_IGNORE); });
  }
  counting::PendingCollective barrier;
  barrier.begin(comm_, [&](MPI_Request* request) { MPI_Ibarrier(comm_, request); });
  do receive_piece(tag);
  while (!barrier.test());
  end_round();
  if (failed_) std::rethrow_exception(failed_);
}

}  // namespace silt::parallel
