#include "coupler/placement/start_positions.hpp"

#include <algorithm>
#include <limits>

#include "coupler/case/case.hpp"
#include "coupler/placement/place_bodies.hpp"
#include "parallel/communicator.hpp"

namespace silt::coupler {

using rigid::BodyId;
using rigid::Vec3;

/// The starts of those bodies whose meeting place this rank is.
std::vector<StartPositions::Start> StartPositions::met_here(const Case& setup, const lbm::Domain& domain,
                                                            MPI_Comm comm) {
  const int ranks = parallel::ranks_of(comm);
  parallel::Messages messages(comm);
  place_bodies(setup, domain, comm).for_each([&](BodyId id, const BodySpec& body) {
    const Vec3& x = body.pose.position;
    parallel::put(messages.to(static_cast<int>(id % ranks)), Start{id, {x[0], x[1], x[2]}});
  });
  messages.unannounced();
  std::vector<Start> starts;
  messages.for_received<Start>([&](const Start& start, int) { starts.push_back(start); });
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.id < b.id; });
  return starts;
}

StartPositions::Start StartPositions::found(const std::vector<Start>& starts, BodyId id) {
  constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
  const auto at = std::lower_bound(starts.begin(), starts.end(), id,
                                   [](const Start& s, BodyId wanted) { return s.id < wanted; });
  return at != starts.end() && at->id == id ? *at : Start{id, {nowhere, nowhere, nowhere}};
}

std::vector<Vec3> StartPositions::of(const Case& setup, const lbm::Domain& domain, MPI_Comm comm,
                                     std::span<const BodyId> ids) const {
  if (!starts_) starts_ = met_here(setup, domain, comm);
  const int ranks = parallel::ranks_of(comm);
  parallel::Messages messages(comm);
  for (const BodyId id : ids) parallel::put(messages.to(static_cast<int>(id % ranks)), id);
  messages.unannounced();
  std::vector<std::pair<int, BodyId>> asked;
  messages.for_received<BodyId>([&](BodyId id, int rank) { asked.emplace_back(rank, id); });
  for (const auto& [rank, id] : asked) parallel::put(messages.to(rank), found(*starts_, id));
  messages.unannounced();
  std::vector<Start> answers;
  messages.for_received<Start>([&](const Start& start, int) { answers.push_back(start); });
  std::sort(answers.begin(), answers.end(), [](const Start& a, const Start& b) { return a.id < b.id; });
  std::vector<Vec3> positions;
  for (const BodyId id : ids) positions.push_back(Eigen::Map<const Vec3>{found(answers, id).position});
  return positions;
}

}  // namespace silt::coupler
