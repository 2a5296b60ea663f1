#pragma once
// Messages that both ends expect, with their greatest lengths: begun together, waited for together.
#include <mpi.h>

#include <cstddef>
#include <span>
#include <vector>

namespace silt::parallel {

class Transfers {
 public:
  /// All go by this communicator and tag.
  Transfers(MPI_Comm comm, int tag) : comm_(comm), tag_(tag) {}
  Transfers(Transfers&&) = default;

  /// Begin a message to or from a rank. Its values stay in place until wait(), and may be fewer than the
  /// room.
  template <class T>
  void send(int to, std::span<T> values) {
    send(to, values.data(), values.size(), sizeof(T));
  }
  template <class T>
  void receive(int from, std::span<T> room) {
    receive(from, room.data(), room.size(), sizeof(T));
  }
  /// Begin a message of values of so many bytes each. std::length_error if there are 2^31 of them.
  void send(int to, const void* values, std::size_t count, std::size_t value_bytes);
  void receive(int from, void* room, std::size_t count, std::size_t value_bytes);

  void progress();
  void wait();
  /// Returns the bytes of the k-th message, one received, before the last wait(), if progress() was not
  /// called.
  std::size_t bytes_received(std::size_t k) const;
  /// Makes room for so many messages, so that beginning them needs no memory.
  void reserve(std::size_t messages);

 private:
  MPI_Comm comm_;
  int tag_;
  std::vector<MPI_Request> requests_;
  std::vector<MPI_Status> statuses_;
};

}  // namespace silt::parallel
