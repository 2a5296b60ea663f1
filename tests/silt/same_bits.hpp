#pragma once
// The same bits: on any number of ranks, in any blocks, and in a run that goes on from a checkpoint.
#include <concepts>
#include <memory>

#include "silt/case/case.hpp"
#include "silt/results/build_info.hpp"
#include "silt/results/checkpoint.hpp"
#include "silt/results/quantities.hpp"
#include "silt/simulation.hpp"
#include "tests/adapters/hdf5/scratch.hpp"
#include "tests/silt/case/case_text.hpp"
#include "tests/world.hpp"

namespace silt::testing {

/// Expects that a scene has the same state after so many steps on one rank in one block and on all ranks in
/// `blocks`, of which each is a value of domain.blocks. start(communicator, overrides) makes the simulation.
/// Returns the hash of that state.
template <std::invocable<MPI_Comm, const Overrides&> Start>
std::uint64_t expect_one_hash(Start&& start, int steps, std::initializer_list<const char*> blocks) {
  const auto hash = [&](const std::string& cut, MPI_Comm comm) {
    Simulation simulation = start(comm, Overrides{"domain.blocks=" + cut});
    simulation.run(steps);
    return simulation.hash();
  };
  const std::uint64_t alone = tests::alone([&] { return hash("\"auto\"", MPI_COMM_SELF); });
  for (const char* cut : blocks) EXPECT_EQ(hash(cut, MPI_COMM_WORLD), alone) << "blocks of " << cut;
  return alone;
}
inline std::uint64_t expect_one_hash(const CaseText& text, int steps,
                                     std::initializer_list<const char*> blocks) {
  return expect_one_hash([&](MPI_Comm comm, const Overrides& cut) { return text.start(comm, cut); }, steps,
                         blocks);
}

/// The state of a run in a checkpoint.
class Saved {
 public:
  explicit Saved(const Simulation& simulation) : Saved(simulation, Quantities(simulation.setup())) {}
  Saved(const Simulation& simulation, const Quantities& quantities)
      : path_(write_checkpoint(simulation, {quantities}, scratch_.path(),
                               provenance_of(simulation.setup(), tests::ranks(), "auto"))) {}

  const std::filesystem::path& path() const { return path_; }
  adapters::CheckpointReader reader(MPI_Comm comm = MPI_COMM_WORLD) const { return {comm, path_}; }
  /// Returns the run that goes on from it.
  std::unique_ptr<Simulation> go_on(const Case& setup, MPI_Comm comm = MPI_COMM_WORLD) const {
    return resumed_simulation(reader(comm), setup, comm);
  }

 private:
  tests::Scratch scratch_;
  std::filesystem::path path_;
};

/// Expects that so many steps lead from a checkpoint to the state to which they lead without one.
inline void expect_goes_on(Simulation& simulation, int steps) {
  const Saved saved(simulation);
  const auto again = saved.go_on(simulation.setup());
  simulation.run(steps);
  again->run(steps);
  EXPECT_EQ(again->hash(), simulation.hash());
}

}  // namespace silt::testing
