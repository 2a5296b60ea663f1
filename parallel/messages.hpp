#pragma once
// Messages between some ranks: buffers of bytes, one a rank, filled and then exchanged in one of two ways.
//
//   with_partners   both ends know that they talk to each other (not how much they have to say)
//   unannounced     a rank does not know who will write to it: the sparse dynamic consensus of Hoefler,
//                   Siebert and Lumsdaine (PPoPP 2010): synchronous sends, and a barrier that no rank enters
//                   before its messages were taken. Its cost is a barrier and the messages themselves, on
//                   any number of ranks.
//
// What came in is handed out in the order of ranks, so that nothing depends on who was first. A rank keeps
// nothing that grows with the number of ranks.
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

/// Takes apart what put() put together.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : left_(bytes) {}
  bool done() const { return left_.empty(); }
  template <class T>
  requires std::is_trivially_copyable_v<T> T take() {
    T value;
    take(std::span<T>(&value, 1));
    return value;
  }
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void take(std::span<T> values) {
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
    int rank;  // the other end
    Bytes bytes;
  };

  explicit Messages(MPI_Comm comm) : comm_(comm) {}  // collective: they go over a communicator of their own

  MPI_Comm comm() const { return comm_; }
  /// Returns the message to a rank, empty at the start of a round; to itself in unannounced rounds only.
  Bytes& to(int rank);
  /// Sends what to() was called for, and receives one message, possibly empty, from each of the sources.
  void with_partners(std::span<const int> sources);
  /// Collective. Sends what to() was called for, and receives whatever was sent here. Throws if this rank has
  /// no memory for what comes; after make_room() only at the end of the round, to which all ranks come, so
  /// that it may be called within `together`.
  void unannounced();
  void make_room();
  /// Returns the messages of the last round, by source.
  const std::vector<Message>& received() const { return received_; }
  /// Calls f(value, rank) for each value of messages that hold values of one type.
  template <class T, class F>
  void for_received(F&& f) const {
    for (const Message& message : received_)
      for (ByteReader reader(message.bytes); !reader.done();) f(reader.take<T>(), message.rank);
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
  Round sent_, received_, spare_;  // kept, buffers and all, from round to round
  Bytes piece_;                    // the last one that came
  std::vector<MPI_Request> requests_;
  std::exception_ptr failed_;  // in this round, for want of memory
  int round_ = 0;
  std::uint64_t messages_sent_ = 0, bytes_sent_ = 0;
};

}  // namespace silt::parallel
