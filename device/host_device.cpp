#include "device/host_device.hpp"

#include <sys/mman.h>

#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "device/untouched_pool.hpp"

namespace silt {

namespace {

/// Whole pages that are inaccessible except while passes run. A pool above it requests few large pieces.
class LockedMemory final : public std::pmr::memory_resource {
 public:
  void lock(bool locked) {
    for (const auto& [memory, bytes] : all_)
      mprotect(memory, bytes, locked ? PROT_NONE : PROT_READ | PROT_WRITE);
  }

 private:
  void* do_allocate(std::size_t bytes, std::size_t) override {
    void* const memory = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    all_[memory] = bytes;
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t) override {
    munmap(memory, bytes);
    all_.erase(memory);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  std::map<void*, std::size_t> all_;
};

LockedMemory& locked_memory() {
  static auto* const memory = new LockedMemory;  // outlives all arrays
  return *memory;
}

struct Deferred {
  void (*run)(const void*);
  std::unique_ptr<std::byte[]> work;
};
std::vector<Deferred> yet_to_do;

}  // namespace

void defer_work(void (*run)(const void*), const void* work, std::size_t bytes) {
  yet_to_do.push_back({run, std::make_unique<std::byte[]>(bytes)});
  std::memcpy(yet_to_do.back().work.get(), work, bytes);
}

void run_deferred_work() {
  if (yet_to_do.empty()) return;
  locked_memory().lock(false);
  for (const Deferred& one : yet_to_do) one.run(one.work.get());
  yet_to_do.clear();
  locked_memory().lock(true);
}

std::pmr::memory_resource* own_memory_of_host() {
  static auto* const pool = new UntouchedPool(&locked_memory());
  return pool;
}

}  // namespace silt
