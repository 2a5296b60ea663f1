#pragma once
// Messages between some ranks: buffers of bytes, one a rank, filled and then exchanged in one of two ways.
//
//   with_partners   both ends know that they talk to each other (not how much they have to say)
//   unannounced     a rank does not know who will write to it: the sparse dynamic consensus of Hoefler,
//   Siebert and
//                   Lumsdaine (PPoPP 2010): synchronous sends, and a barrier that no rank enters before its
//                   messages were taken. Its cost is a barrier and the messages themselves, on any number of
//                   ranks.
//
// What came in is handed out in the order of ranks, so that nothing depends on who was first.
#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

namespace silt::coupler {

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

  /// Collective: traffic goes over a communicator of its own.
  explicit Messages(MPI_Comm);
  ~Messages();
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

  MPI_Comm comm() const { return comm_; }
  /// What is to be sent to a rank; at the start of a round nothing. To this one only in unannounced rounds.
  Bytes& to(int rank);
  /// Sends what to() was called for, and receives one message, possibly empty, from each of the sources.
  void with_partners(std::span<const int> sources);
  /// Collective. Sends what to() was called for, and receives whatever was sent here.
  void unannounced();
  /// Returns the messages of the last round, by source.
  const std::vector<Message>& received() const { return received_; }

  std::uint64_t messages_sent() const { return messages_sent_; }
  std::uint64_t bytes_sent() const { return bytes_sent_; }

 private:
  void send_all(int tag, bool synchronous);
  void end_round();
  Message& next_received();

  MPI_Comm comm_ = MPI_COMM_NULL;
  std::vector<Message> sent_, received_;  // kept, buffers and all, from round to round
  std::vector<Message> spare_;
  std::vector<int> place_;  // of a rank in sent_, -1: not yet in this round
  std::vector<MPI_Request> requests_;
  int round_ = 0;
  std::uint64_t messages_sent_ = 0, bytes_sent_ = 0;
};

}  // namespace silt::coupler
