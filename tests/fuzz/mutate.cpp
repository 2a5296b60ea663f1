// mutate SECONDS KEPT SEED_FILE...: feeds a harness (LLVMFuzzerTestOneInput) the seeds and what becomes of
// them by random changes, the same in every run. An input is in the file KEPT while it is tried: there it
// stays if it brings the program down, or takes longer than 20 s (-: nowhere). Prints how many were tried.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t*, std::size_t);

namespace {

using Bytes = std::string;

class Mutator {
 public:
  explicit Mutator(std::vector<Bytes> seeds) : seeds_(std::move(seeds)) {}

  Bytes next() {
    Bytes input = seeds_[below(seeds_.size())];
    for (std::size_t changes = 1 + below(6); changes > 0; --changes) change(input);
    return input;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  /// A piece of at most 40 bytes.
  Bytes piece_of(const Bytes& all) {
    const std::size_t begin = below(all.size() + 1);
    return all.substr(begin, below(40));
  }
  void change(Bytes& input) {
    static const std::vector<Bytes> odd = {
        "-1",   "0",    "1e308", "-1e-320", "nan", "inf", "9223372036854775807",
        "[",    "]",    "{",     "\"",      "\n",  "=",   "\xc3\xa9",
        "\xff", "1e-9", "0.5",   "[[",      "'''", "#"};
    const std::size_t at = below(input.size() + 1);
    switch (below(7)) {
      case 0:
        if (at < input.size()) input[at] = char(input[at] ^ (1 << below(8)));
        break;
      case 1:
        if (at < input.size()) input[at] = char(random_());
        break;
      case 2:
        input.erase(at, below(40));
        break;
      case 3:
        input.insert(at, piece_of(seeds_[below(seeds_.size())]));
        break;
      case 4:
        input.insert(at, odd[below(odd.size())]);
        break;
      case 5:
        replace_number(input, at, odd[below(odd.size())]);
        break;
      default:
        input.insert(at, piece_of(input));
    }
  }
  static void replace_number(Bytes& input, std::size_t from, const Bytes& by) {
    const std::size_t begin = input.find_first_of("0123456789", from);
    if (begin == input.npos) return;
    input.replace(begin, std::min(input.find_first_not_of("0123456789.e-", begin), input.size()) - begin, by);
  }

  std::vector<Bytes> seeds_;
  std::mt19937_64 random_{1};
};

Bytes content_of(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void attempt(const Bytes& input, const char* kept) {
  if (kept) std::ofstream(kept, std::ios::binary) << input;
  alarm(20);  // ends the program
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  alarm(0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return std::fprintf(stderr, "usage: mutate SECONDS KEPT SEED_FILE...\n"), 2;
  std::vector<Bytes> seeds;
  for (int i = 3; i < argc; ++i) seeds.push_back(content_of(argv[i]));
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(std::atoi(argv[1]));
  const char* const kept = std::string(argv[2]) == "-" ? nullptr : argv[2];
  long tried = 0;
  for (const Bytes& seed : seeds) attempt(seed, kept), ++tried;
  for (Mutator mutator(seeds); std::chrono::steady_clock::now() < end; ++tried) attempt(mutator.next(), kept);
  if (kept) std::remove(kept);
  std::printf("%ld inputs from %zu seeds, no fault\n", tried, seeds.size());
  std::fflush(nullptr);
  std::_Exit(0);  // MPI, if a harness has started it, need not end
}
