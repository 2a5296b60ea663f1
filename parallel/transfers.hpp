#pragma once
// Point-to-point messages between ranks that both expect them, with known upper limits of their lengths.
#include <mpi.h>

#include <cstddef>
#include <span>
#include <vector>

namespace silt::parallel {

class Transfers {
 public:
  /// All messages use this communicator and tag.
  Transfers(MPI_Comm comm, int tag) : comm_(comm), tag_(tag) {}
  Transfers(Transfers&&) = default;

  /// Start a message to or from a rank. Values stay in place until wait(). Fewer may be received.
  template <class T>
  void send(int to, std::span<T> values) {
    send(to, values.data(), values.size(), sizeof(T));
  }
  template <class T>
  void receive(int from, std::span<T> room) {
    receive(from, room.data(), room.size(), sizeof(T));
  }
  /// Start a message of values of this size each. Throws std::length_error for 2^31 values or more.
  void send(int to, const void* values, std::size_t count, std::size_t value_bytes);
  void receive(int from, void* room, std::size_t count, std::size_t value_bytes);

  void progress();
  void wait();
  /// Returns the size of the k-th message, a received one, before the last wait() without progress().
  std::size_t bytes_received(std::size_t k) const;
  /// Reserves memory for this number of messages, so that starting them needs none.
  void reserve(std::size_t messages);

 private:
  MPI_Comm comm_;
  int tag_;
  std::vector<MPI_Request> requests_;
  std::vector<MPI_Status> statuses_;
};

}  // namespace silt::parallel
