#include "coupler/run/start_mpi.hpp"

#include <mpi.h>

#include <cstdlib>
#include <string_view>

namespace silt::coupler {
namespace {

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

/// Sets a parameter of Open MPI, unless the user did; other implementations do not look at it.
void propose(const char* parameter, const char* value) {
  setenv(parameter, value, 0);
}

/// Whether no launcher started this process: it is the only one of its run.
bool is_alone() {
  for (const char* of_launcher : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_FD", "SLURM_PROCID"})
    if (!variable(of_launcher).empty()) return false;
  return true;
}

/// Whether all ranks are on this machine, as mpirun of Open MPI says.
bool is_one_machine() {
  const std::string_view ranks = variable("OMPI_COMM_WORLD_SIZE");
  return !ranks.empty() && ranks == variable("OMPI_COMM_WORLD_LOCAL_SIZE");
}

/// On one machine nobody looks for networks, and a process alone needs neither a daemon beside it nor a
/// folder for messages: MPI starts in 0.07 s instead of 0.5, and on 8 ranks in 0.6 instead of 0.8 (Open MPI
/// 4.1).
void propose_parameters() {
  // The usual component for shared file pointers, which nothing here uses, overflows with paths above 240
  // bytes.
  propose("OMPI_MCA_sharedfp", "individual");
  // To read another rank's memory is forbidden in most containers.
  propose("OMPI_MCA_btl_vader_single_copy_mechanism", "none");
  if (is_alone()) {
    propose("OMPI_MCA_ess_singleton_isolated", "1");
    propose("OMPI_MCA_orte_create_session_dirs", "0");
    propose("OMPI_MCA_btl", "self");
  } else if (is_one_machine()) {
    propose("OMPI_MCA_btl", "self,vader");
  } else {
    return;
  }
  propose("OMPI_MCA_pml", "ob1");
}

}  // namespace

bool start_mpi(int* argc, char*** argv) {
  int started = 0;
  MPI_Initialized(&started);
  if (started) return false;
  propose_parameters();
  MPI_Init(argc, argv);
  return true;
}

}  // namespace silt::coupler
