#pragma once
// Messages between ranks: a buffer of bytes for each destination, exchanged in one of two ways.
//
//   exchange_with   every rank knows from which ranks it receives (not how much)
//   exchange_sparse ranks do not know who will send to them: nonblocking consensus (Hoefler, Siebert,
//   Lumsdaine,
//                   PPoPP 2010), with synchronous sends and a barrier that a rank enters once its messages
//                   were received. It costs a barrier and the messages, on any number of ranks.
//
// Received messages are in rank order, not in that of arrival. Memory does not grow with the rank count.
#include <mpi.h>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "parallel/communicator.hpp"

namespace silt::parallel {
using Bytes = std::vector<std::byte>;

template <class T>
requires std::is_trivially_copyable_v<T>
void put(Bytes& to, const T& value) {
  const auto* from = reinterpret_cast<const std::byte*>(&value);
  to.insert(to.end(), from, from + sizeof(T));
}

template <class T>
requires std::is_trivially_copyable_v<T>
void put(Bytes& to, std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// Reads values in the order in which put() wrote them.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : left_(bytes) {}
  bool done() const { return left_.empty(); }
  template <class T>
  requires std::is_trivially_copyable_v<T> T read() {
    T value;
    read(std::span<T>(&value, 1));
    return value;
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void read(std::span<T> values) {
    if (left_.size() < values.size_bytes()) throw std::logic_error("a message between ranks is too short");
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), left_.data(), values.size_bytes());
    left_ = left_.subspan(values.size_bytes());
  }

 private:
  std::span<const std::byte> left_;
};

class Messages {
 public:
  struct Message {
    int rank;  // destination or source
    Bytes bytes;
  };

  explicit Messages(MPI_Comm comm) : comm_(comm) {}  // collective: duplicates the communicator

  MPI_Comm comm() const { return comm_; }
  /// Returns the message to a rank, empty at the start of a round; to itself only in exchange_sparse().
  Bytes& to(int rank);
  /// Sends the messages for which to() was called, and receives one, possibly empty, from each source.
  void exchange_with(std::span<const int> sources);
  /// Collective. Sends the messages for which to() was called, and receives all messages to this rank. Throws
  /// if memory for these is exhausted; after make_room() only at the end of the round, which all ranks reach,
  /// so that it may be called within `together`.
  void exchange_sparse();
  void make_room();
  /// Returns the messages of the last round, by source.
  const std::vector<Message>& received() const { return received_; }
  /// Calls f(value, rank) for each value in the messages, which contain values of type T only.
  template <class T, class F>
  void for_received(F&& f) const {
    for (const Message& message : received_)
      for (ByteReader reader(message.bytes); !reader.done();) f(reader.read<T>(), message.rank);
  }

  std::uint64_t messages_sent() const { return messages_sent_; }
  std::uint64_t bytes_sent() const { return bytes_sent_; }

 private:
  using Round = std::vector<Message>;  // by rank
  Message& message_of(Round&, int rank);
  void begin_round();
  void end_round();
  void send(const Message&, std::size_t first, std::size_t bytes, int tag, bool synchronous);
  void receive_piece(int tag);

  OwnCommunicator comm_;
  Round sent_, received_, spare_;  // buffers are reused
  Bytes piece_;                    // last received piece
  std::vector<MPI_Request> requests_;
  std::exception_ptr failed_;  // in this round, for lack of memory
  int round_ = 0;
  std::uint64_t messages_sent_ = 0, bytes_sent_ = 0;
};

/// Point-to-point messages between ranks that both expect them, with known upper limits of their lengths.
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
