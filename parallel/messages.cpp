#include "parallel/messages.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
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

namespace {

constexpr std::size_t most = std::numeric_limits<int>::max();  // MPI counts in int

/// Calls act(count, type) for a message: as bytes, or as values if the number of bytes exceeds an int.
template <class Act>
void as_type(int rank, std::size_t count, std::size_t value_bytes, Act&& act) {
  if (count * value_bytes <= most) return act(int(count * value_bytes), MPI_BYTE);
  if (count > most)
    throw std::length_error("a message of " + std::to_string(count) + " values between this rank and rank " +
                            std::to_string(rank) + " is longer than MPI can send: use more ranks");
  MPI_Datatype type;
  MPI_Type_contiguous(int(value_bytes), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  act(int(count), type);
  MPI_Type_free(&type);  // MPI frees it when the operations that use it have finished
}

}  // namespace

void Transfers::send(int to, const void* values, std::size_t count, std::size_t value_bytes) {
  as_type(to, count, value_bytes, [&](int n, MPI_Datatype type) {
    counting::count_message(count * value_bytes);
    MPI_Isend(values, n, type, to, tag_, comm_, &requests_.emplace_back());
  });
}

void Transfers::receive(int from, void* room, std::size_t count, std::size_t value_bytes) {
  as_type(from, count, value_bytes, [&](int n, MPI_Datatype type) {
    MPI_Irecv(room, n, type, from, tag_, comm_, &requests_.emplace_back());
  });
}

void Transfers::progress() {
  if (requests_.empty()) return;
  int done = 0;
  counting::waiting(
      [&] { MPI_Testall(int(requests_.size()), requests_.data(), &done, MPI_STATUSES_IGNORE); });
}

void Transfers::wait() {
  statuses_.resize(requests_.size());
  counting::waiting([&] { MPI_Waitall(int(requests_.size()), requests_.data(), statuses_.data()); });
  requests_.clear();
}

std::size_t Transfers::bytes_received(std::size_t k) const {
  int bytes = 0;
  MPI_Get_count(&statuses_[k], MPI_BYTE, &bytes);
  return std::size_t(bytes);
}

void Transfers::reserve(std::size_t messages) {
  requests_.reserve(messages);
  statuses_.reserve(messages);
}

}  // namespace silt::parallel
