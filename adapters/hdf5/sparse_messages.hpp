#pragma once
// Private to adapters/hdf5: messages to ranks that do not know who will write to them.
#include <mpi.h>

#include <cstddef>
#include <exception>
#include <span>
#include <vector>

namespace silt::adapters::hdf5 {

/// SparseMessages swaps messages by the sparse dynamic consensus of Hoefler, Siebert, Lumsdaine (PPoPP 2010):
/// synchronous sends, and a barrier that no rank enters before its messages were taken. A rank keeps nothing
/// that grows with their number.
class SparseMessages {
 public:
  struct Message {
    int rank;  // the other end
    std::vector<std::byte> bytes;
  };

  /// Collective: messages go over a communicator of their own.
  explicit SparseMessages(MPI_Comm);
  ~SparseMessages();
  SparseMessages(const SparseMessages&) = delete;
  SparseMessages& operator=(const SparseMessages&) = delete;

  MPI_Comm comm() const { return comm_; }
  /// Collective. Sends each message, at most one to a rank, in pieces, and returns those that came, by rank.
  /// Throws on every rank where one has no memory for what comes.
  std::vector<Message> swap(const std::vector<Message>& sent);

 private:
  static constexpr std::size_t piece_bytes = 1 << 16;
  void take(std::vector<Message>& received, int rank, std::size_t bytes);
  void receive(int tag, std::vector<Message>& received, std::exception_ptr& failed);

  std::vector<std::byte> piece_;  // the last one that came
  MPI_Comm comm_ = MPI_COMM_NULL;
  int round_ = 0;
};

/// Appends plain values to a message.
template <class T>
void put(std::vector<std::byte>& to, const T& value) {
  const auto bytes = std::as_bytes(std::span(&value, 1));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

}  // namespace silt::adapters::hdf5
