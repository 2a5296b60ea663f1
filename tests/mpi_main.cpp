// The entry of every test program: MPI around GoogleTest; only rank 0 prints, a failure on any rank fails
// all.
#include <gtest/gtest.h>
#include <mpi.h>

#include <string_view>

#include "tests/act.hpp"

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  testing::InitGoogleTest(&argc, argv);
  if (argc == 3 && std::string_view(argv[1]) == "--act") {
    silt::tests::acts().at(argv[2])();
    const bool bad = testing::UnitTest::GetInstance()->ad_hoc_test_result().Failed();
    MPI_Finalize();
    return bad;
  }
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  auto& listeners = testing::UnitTest::GetInstance()->listeners();
  class Reporter : public testing::EmptyTestEventListener {
    void OnTestPartResult(const testing::TestPartResult& r) override {
      if (r.failed())
        fprintf(stderr, "%s:%d: %s\n", r.file_name() ? r.file_name() : "?", r.line_number(), r.summary());
    }
  };
  if (rank != 0) {
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new Reporter);
  }
  int failed = RUN_ALL_TESTS(), any = 0;
  MPI_Allreduce(&failed, &any, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  MPI_Finalize();
  return any;
}
