#include "coupler/exchange/messages.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace silt::coupler {

namespace {
constexpr int partner_tag = 0;
/// A rank may be one round of unannounced messages ahead of another, never two: two tags keep them apart.
constexpr int first_unannounced_tag = 1;
}  // namespace

Messages::Messages(MPI_Comm comm) {
  MPI_Comm_dup(comm, &comm_);
  int ranks = 0;
  MPI_Comm_size(comm_, &ranks);
  place_.assign(ranks, -1);
}

Messages::~Messages() {
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (!finalized) MPI_Comm_free(&comm_);
}

Bytes& Messages::to(int rank) {
  if (place_[rank] >= 0) return sent_[place_[rank]].bytes;
  place_[rank] = static_cast<int>(sent_.size());
  if (spare_.empty()) spare_.push_back({rank, {}});
  sent_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  sent_.back().rank = rank;
  sent_.back().bytes.clear();
  return sent_.back().bytes;
}

Messages::Message& Messages::next_received() {
  if (spare_.empty()) spare_.push_back({});
  received_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  return received_.back();
}

void Messages::send_all(int tag, bool synchronous) {
  for (Message& m : received_) spare_.push_back(std::move(m));
  received_.clear();
  requests_.resize(sent_.size());
  for (std::size_t k = 0; k < sent_.size(); ++k) {
    const Message& m = sent_[k];
    const auto send = synchronous ? MPI_Issend : MPI_Isend;
    if (m.bytes.size() > std::numeric_limits<int>::max())
      throw std::length_error("a message of " + std::to_string(m.bytes.size()) + " bytes to rank " +
                              std::to_string(m.rank) + " is longer than MPI can send: use more ranks");
    send(m.bytes.data(), static_cast<int>(m.bytes.size()), MPI_BYTE, m.rank, tag, comm_, &requests_[k]);
    ++messages_sent_;
    bytes_sent_ += m.bytes.size();
  }
}

void Messages::end_round() {
  for (Message& m : sent_) {
    place_[m.rank] = -1;
    spare_.push_back(std::move(m));
  }
  sent_.clear();
  std::sort(received_.begin(), received_.end(), [](const auto& p, const auto& q) { return p.rank < q.rank; });
}

namespace {
void receive(MPI_Message& matched, const MPI_Status& status, Messages::Message& into) {
  int size = 0;
  MPI_Get_count(&status, MPI_BYTE, &size);
  into.rank = status.MPI_SOURCE;
  into.bytes.resize(size);
  MPI_Mrecv(into.bytes.data(), size, MPI_BYTE, &matched, MPI_STATUS_IGNORE);
}
}  // namespace

void Messages::with_partners(std::span<const int> sources) {
  send_all(partner_tag, false);
  for (const int source : sources) {
    MPI_Message matched;
    MPI_Status status;
    MPI_Mprobe(source, partner_tag, comm_, &matched, &status);
    receive(matched, status, next_received());
  }
  MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE);
  end_round();
}

void Messages::unannounced() {
  const int tag = first_unannounced_tag + round_++ % 2;
  send_all(tag, true);
  MPI_Request barrier = MPI_REQUEST_NULL;
  bool in_barrier = false;
  for (int done = 0; !done;) {
    int found = 0;
    MPI_Message matched;
    MPI_Status status;
    MPI_Improbe(MPI_ANY_SOURCE, tag, comm_, &found, &matched, &status);
    if (found) receive(matched, status, next_received());
    if (in_barrier) {
      MPI_Test(&barrier, &done, MPI_STATUS_IGNORE);
      continue;
    }
    int taken = 0;
    MPI_Testall(static_cast<int>(requests_.size()), requests_.data(), &taken, MPI_STATUSES_IGNORE);
    if (taken) {
      MPI_Ibarrier(comm_, &barrier);
      in_barrier = true;
    }
  }
  end_round();
}

}  // namespace silt::coupler
