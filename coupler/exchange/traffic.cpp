#include "coupler/exchange/traffic.hpp"

#include <mpi.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace silt::coupler {

namespace {

Traffic counts;
std::uint64_t step = 0;
/// Nonblocking collectives under way, and the steps that started them: a few at most.
std::vector<std::pair<MPI_Request, std::uint64_t>> under_way;

bool is_alone(MPI_Comm comm) {
  int ranks = 1;
  PMPI_Comm_size(comm, &ranks);
  return ranks == 1;
}

/// Calls what may wait for another rank, and takes the time.
template <class Call>
int waiting(Call&& call) {
  const double begin = PMPI_Wtime();
  const int result = call();
  counts.waited += PMPI_Wtime() - begin;
  return result;
}

void count_message(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  ++counts.messages;
  counts.empty_messages += count == 0;
  counts.bytes += std::uint64_t(count) * std::uint64_t(size);
}

template <class Call>
int blocking_collective(MPI_Comm comm, Call&& call) {
  if (is_alone(comm)) return call();
  ++counts.blocking_collectives;
  return waiting(call);
}

template <class Call>
int nonblocking_collective(MPI_Comm comm, const MPI_Request* request, Call&& call) {
  const int result = call();
  if (!is_alone(comm)) under_way.push_back({*request, step});
  return result;
}

/// A request that is over; `handle` is what it was called.
void end_request(MPI_Request handle) {
  const auto at = std::find_if(under_way.begin(), under_way.end(),
                               [&](const auto& started) { return started.first == handle; });
  if (at == under_way.end()) return;
  ++(at->second == step ? counts.blocking_collectives : counts.collectives_under_way);
  under_way.erase(at);
}

}  // namespace

const Traffic& traffic() {
  return counts;
}

void begin_step_of_traffic() {
  ++step;
}

}  // namespace silt::coupler

using namespace silt::coupler;

// ---- messages ----

int MPI_Send(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  count_message(count, type);
  return waiting([&] { return PMPI_Send(data, count, type, to, tag, comm); });
}
int MPI_Isend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request* request) {
  count_message(count, type);
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}
int MPI_Issend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
               MPI_Request* request) {
  count_message(count, type);
  return PMPI_Issend(data, count, type, to, tag, comm, request);
}
int MPI_Recv(void* data, int count, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status* status) {
  return waiting([&] { return PMPI_Recv(data, count, type, from, tag, comm, status); });
}
int MPI_Mprobe(int from, int tag, MPI_Comm comm, MPI_Message* message, MPI_Status* status) {
  return waiting([&] { return PMPI_Mprobe(from, tag, comm, message, status); });
}
int MPI_Improbe(int from, int tag, MPI_Comm comm, int* found, MPI_Message* message, MPI_Status* status) {
  return waiting([&] { return PMPI_Improbe(from, tag, comm, found, message, status); });
}
int MPI_Mrecv(void* data, int count, MPI_Datatype type, MPI_Message* message, MPI_Status* status) {
  return waiting([&] { return PMPI_Mrecv(data, count, type, message, status); });
}

// ---- waiting ----

int MPI_Wait(MPI_Request* request, MPI_Status* status) {
  const MPI_Request handle = *request;
  const int result = waiting([&] { return PMPI_Wait(request, status); });
  end_request(handle);
  return result;
}
int MPI_Waitall(int count, MPI_Request* requests, MPI_Status* statuses) {
  return waiting([&] { return PMPI_Waitall(count, requests, statuses); });
}
int MPI_Test(MPI_Request* request, int* done, MPI_Status* status) {
  const MPI_Request handle = *request;
  const int result = waiting([&] { return PMPI_Test(request, done, status); });
  if (*done) end_request(handle);
  return result;
}
int MPI_Testall(int count, MPI_Request* requests, int* done, MPI_Status* statuses) {
  return waiting([&] { return PMPI_Testall(count, requests, done, statuses); });
}

// ---- collectives ----

int MPI_Barrier(MPI_Comm comm) {
  return blocking_collective(comm, [&] { return PMPI_Barrier(comm); });
}
int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  return blocking_collective(comm, [&] { return PMPI_Bcast(data, count, type, root, comm); });
}
int MPI_Reduce(const void* mine, void* all, int count, MPI_Datatype type, MPI_Op op, int root,
               MPI_Comm comm) {
  return blocking_collective(comm, [&] { return PMPI_Reduce(mine, all, count, type, op, root, comm); });
}
int MPI_Allreduce(const void* mine, void* all, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  return blocking_collective(comm, [&] { return PMPI_Allreduce(mine, all, count, type, op, comm); });
}
int MPI_Allgather(const void* mine, int count, MPI_Datatype type, void* all, int count_each,
                  MPI_Datatype type_all, MPI_Comm comm) {
  return blocking_collective(
      comm, [&] { return PMPI_Allgather(mine, count, type, all, count_each, type_all, comm); });
}
int MPI_Allgatherv(const void* mine, int count, MPI_Datatype type, void* all, const int counts_all[],
                   const int first[], MPI_Datatype type_all, MPI_Comm comm) {
  return blocking_collective(
      comm, [&] { return PMPI_Allgatherv(mine, count, type, all, counts_all, first, type_all, comm); });
}
int MPI_Alltoall(const void* mine, int count, MPI_Datatype type, void* all, int count_each,
                 MPI_Datatype type_all, MPI_Comm comm) {
  return blocking_collective(
      comm, [&] { return PMPI_Alltoall(mine, count, type, all, count_each, type_all, comm); });
}
int MPI_Alltoallv(const void* mine, const int counts_mine[], const int first_mine[], MPI_Datatype type,
                  void* all, const int counts_all[], const int first_all[], MPI_Datatype type_all,
                  MPI_Comm comm) {
  return blocking_collective(comm, [&] {
    return PMPI_Alltoallv(mine, counts_mine, first_mine, type, all, counts_all, first_all, type_all, comm);
  });
}
int MPI_Iallreduce(const void* mine, void* all, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm,
                   MPI_Request* request) {
  return nonblocking_collective(comm, request,
                                [&] { return PMPI_Iallreduce(mine, all, count, type, op, comm, request); });
}
int MPI_Ibarrier(MPI_Comm comm, MPI_Request* request) {
  return nonblocking_collective(comm, request, [&] { return PMPI_Ibarrier(comm, request); });
}
