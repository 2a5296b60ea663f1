#include "coupler/results/sums_of_steps.hpp"

#include <algorithm>
#include <utility>

namespace silt::coupler {

using rigid::ExactSum;

void SumsOfSteps::add(std::size_t quantity, std::int64_t step, std::span<const ExactSum> terms) {
  waiting_.push_back({quantity, step, terms.size()});
  terms_.insert(terms_.end(), terms.begin(), terms.end());
}

void SumsOfSteps::advance(MPI_Comm comm, std::int64_t step, const Fold& fold) {
  if (waiting_.empty() || step - waiting_.front().step < most_steps - 1) return;
  fold_started(fold);
  start(comm);
}

void SumsOfSteps::settle(MPI_Comm comm, const Fold& fold) {
  fold_started(fold);
  if (waiting_.empty()) return;
  start(comm);
  fold_started(fold);
}

void SumsOfSteps::start(MPI_Comm comm) {
  started_ = std::exchange(waiting_, {});
  sums_.start(comm, std::exchange(terms_, {}));
}

void SumsOfSteps::fold_started(const Fold& fold) {
  if (started_.empty()) return;
  auto sum = sums_.finish().begin();
  std::vector<double> values;
  for (const Look& look : started_) {
    values.clear();
    for (std::size_t k = 0; k < look.count; ++k) values.push_back((sum++)->value());
    fold(look.quantity, look.step, values);
  }
  started_.clear();
}

}  // namespace silt::coupler
