// A signal to one rank stops all of them after the same step, soon, also where steps have just become slow.
#include "coupler/run/stop_request.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/world.hpp"

namespace silt::coupler::testing {
namespace {

using Clock = std::chrono::steady_clock;

TEST(StopRequest, is_heard_when_steps_become_a_thousand_times_as_long) {
  catch_signals();
  std::int64_t step = 0;
  {
    StopRequest request(MPI_COMM_WORLD, 0);
    while (step < 5000) {
      std::this_thread::sleep_for(std::chrono::microseconds(20));
      ASSERT_EQ(request.why(++step), "");
    }
    if (tests::rank() == tests::ranks() - 1) std::raise(SIGUSR1);
    const auto told = Clock::now();
    std::string why;
    while (why.empty() && step < 5200) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      why = request.why(++step);
    }
    EXPECT_EQ(why, "told to stop by SIGUSR1");
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - told).count(), 2);
  }
  std::int64_t first = step, last = step;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT64_T, MPI_MIN, MPI_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &last, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD);
  EXPECT_EQ(first, last);
}

}  // namespace
}  // namespace silt::coupler::testing
