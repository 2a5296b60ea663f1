#include "coupler/python/live_simulation.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "coupler/run/prepare_run.hpp"

namespace silt::coupler {

namespace {

PreparedRun prepared_or_unfit(const RunOptions& options, MPI_Comm comm) {
  try {
    return prepare_scene(options, comm);
  } catch (const std::exception& error) {
    throw UnfitCase(error.what());
  }
}

}  // namespace

LiveSimulation::LiveSimulation(const RunOptions& options, MPI_Comm comm) {
  const RunArithmetic arithmetic;
  PreparedRun prepared = prepared_or_unfit(options, comm);
  simulation_ = std::move(prepared.simulation);
  for (const Diagnostic& warning : prepared.warnings) warnings_.push_back(warning.line());
  static const bool told = [] {  // attributes of MPI_COMM_SELF go first when MPI is finalised
    int key = MPI_KEYVAL_INVALID;
    MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, end_all, &key, nullptr);
    MPI_Comm_set_attr(MPI_COMM_SELF, key, nullptr);
    return true;
  }();
  (void)told;
  living().push_back(this);
}

LiveSimulation::~LiveSimulation() {
  std::erase(living(), this);
}

Simulation& LiveSimulation::get() {
  if (!simulation_) throw std::runtime_error("the simulation has ended: MPI is finalised");
  return *simulation_;
}

int LiveSimulation::end_all(MPI_Comm, int, void*, void*) {
  for (LiveSimulation* const one : living()) one->simulation_.reset();
  return MPI_SUCCESS;
}

std::vector<LiveSimulation*>& LiveSimulation::living() {
  static std::vector<LiveSimulation*> all;
  return all;
}

void LiveSimulation::end_alone(const std::string& text) const {
  fmt::print(stderr, "silt: {}\n", text);
  std::fflush(nullptr);
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

}  // namespace silt::coupler
