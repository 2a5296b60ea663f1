#include "parallel/transfers.hpp"

#include <limits>
#include <stdexcept>
#include <string>

#include "parallel/counted.hpp"

namespace silt::parallel {

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
