#include "parallel/together.hpp"

#include <chrono>
#include <new>
#include <optional>
#include <thread>

#include "parallel/collectives.hpp"
#include "parallel/counted.hpp"

namespace silt::parallel {

std::string text_of(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error))
    return "no memory is left (if the machine has some, look at ulimit -v)";
  return error.what();
}

CommonError common_error(const std::exception& error, int mine) {
  const auto* common = dynamic_cast<const CommonError*>(&error);
  return {common ? common->rank : mine, text_of(error)};
}

namespace {
/// Returns the lowest rank with an error or text.
std::optional<int> first_speaker(MPI_Comm comm, bool speaks) {
  const int ranks = ranks_of(comm);
  const std::uint64_t first = least_over_ranks(comm, std::uint64_t(speaks ? rank_of(comm) : ranks));
  return first < std::uint64_t(ranks) ? std::optional(int(first)) : std::nullopt;
}
}  // namespace

std::string text_of_first(MPI_Comm comm, std::string text) {
  if (const auto speaker = first_speaker(comm, !text.empty())) broadcast(comm, text, *speaker);
  return text;
}

void throw_together(MPI_Comm comm, const CommonError* mine) {
  const auto speaker = first_speaker(comm, mine != nullptr);
  if (!speaker) return;
  int of = mine ? mine->rank : 0;
  std::string text = mine ? mine->what() : "";
  broadcast(comm, of, *speaker);
  broadcast(comm, text, *speaker);
  throw CommonError(of, text);
}

bool ErrorBarrier::all_ranks_arrive() {
  const double end = MPI_Wtime() + patience;
  counting::PendingCollective barrier;
  barrier.begin(comm_, [&](MPI_Request* request) { MPI_Ibarrier(comm_, request); });
  while (MPI_Wtime() < end) {
    if (barrier.test()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace silt::parallel
