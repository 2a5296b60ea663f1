#include "device/host_device.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "device/untouched_pool.hpp"

namespace silt {

namespace {

/// Large pages that are inaccessible except while passes run. A pool above it requests few large pieces.
class LockedMemory final : public std::pmr::memory_resource {
 public:
  /// Changes the access to all of it. A call of the system for each allocation would take most of a pass.
  void lock(bool locked) {
    if (std::exchange(has_changed_, false)) find_spans();
    for (const auto& [memory, bytes] : spans_)
      mprotect(memory, bytes, locked ? PROT_NONE : PROT_READ | PROT_WRITE);
  }
  /// Allocates memory with the bytes of a file; null if it cannot.
  void* of_file(int file, std::size_t bytes) {
    void* const memory = mmap(nullptr, bytes, PROT_NONE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) return nullptr;
    add(memory, bytes);
    return memory;
  }
  bool has(const void* at) const {
    auto next = all_.upper_bound(static_cast<char*>(const_cast<void*>(at)));
    if (next == all_.begin()) return false;
    --next;
    return at < next->first + next->second;
  }

 private:
  void add(void* memory, std::size_t bytes) {
    all_[static_cast<char*>(memory)] = bytes;
    has_changed_ = true;
  }
  void find_spans() {
    spans_.clear();
    for (const auto& [memory, bytes] : all_)
      if (!spans_.empty() && spans_.back().first + spans_.back().second == memory)
        spans_.back().second += bytes;
      else
        spans_.emplace_back(memory, bytes);
  }
  static std::size_t whole(std::size_t bytes) { return (bytes + host_page - 1) / host_page * host_page; }
  void* do_allocate(std::size_t bytes, std::size_t) override {
    char* const from = static_cast<char*>(
        mmap(nullptr, whole(bytes) + host_page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (from == MAP_FAILED) throw std::bad_alloc();
    char* const memory = from + (host_page - reinterpret_cast<std::uintptr_t>(from) % host_page);
    munmap(from, std::size_t(memory - from));
    if (const auto rest = std::size_t(from + host_page - memory)) munmap(memory + whole(bytes), rest);
#if defined(MADV_HUGEPAGE)
    madvise(memory, whole(bytes), MADV_HUGEPAGE);
#endif
    add(memory, whole(bytes));
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t) override {
    munmap(memory, whole(bytes));
    all_.erase(static_cast<char*>(memory));
    has_changed_ = true;
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::map<char*, std::size_t> all_;
  std::vector<std::pair<char*, std::size_t>> spans_;  // all of it, allocations side by side as one
  bool has_changed_ = false;
};

LockedMemory& locked_memory() {
  static auto* const memory = new LockedMemory;  // outlives all arrays
  return *memory;
}

std::atomic<std::uint64_t> pages_touched;
struct sigaction before_ours;

void count_and_unlock(int signal, siginfo_t* found, void* context);

/// Memory for both processors: a page that the program touches is counted and unlocked.
LockedMemory& shared_memory() {
  static auto* const memory = [] {
    struct sigaction ours {};
    ours.sa_sigaction = count_and_unlock, ours.sa_flags = SA_SIGINFO;
    sigaction(SIGSEGV, &ours, &before_ours);
    return new LockedMemory;
  }();
  return *memory;
}

void count_and_unlock(int signal, siginfo_t* found, void*) {
  const std::uintptr_t at = std::uintptr_t(found->si_addr) / host_page * host_page;
  if (shared_memory().has(found->si_addr) &&
      mprotect(reinterpret_cast<void*>(at), host_page, PROT_READ | PROT_WRITE) == 0)
    ++pages_touched;
  else
    sigaction(signal, &before_ours, nullptr);  // comes again, to the handler that was there before
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
  locked_memory().lock(false), shared_memory().lock(false);
  for (const Deferred& one : yet_to_do) one.run(one.work.get());
  yet_to_do.clear();
  locked_memory().lock(true), shared_memory().lock(true);
}

std::pmr::memory_resource* own_memory_of_host() {
  static auto* const pool = new UntouchedPool(&locked_memory());
  return pool;
}
std::pmr::memory_resource* shared_memory_of_host() {
  static auto* const pool = new UntouchedPool(&shared_memory());
  return pool;
}
std::shared_ptr<void> zeroed_on_host(std::size_t bytes) {
  return {shared_memory().allocate(bytes), [bytes](void* p) { shared_memory().deallocate(p, bytes); }};
}
std::uint64_t pages_touched_on_host() {
  return pages_touched;
}

void* exported_on_host(std::size_t bytes, std::array<std::byte, 64>& name) {
  const int file = memfd_create("silt", MFD_CLOEXEC);  // lives as long as its processes
  void* const memory =
      file >= 0 && ftruncate(file, off_t(bytes)) == 0 ? locked_memory().of_file(file, bytes) : nullptr;
  if (!memory) throw std::bad_alloc();
  std::memcpy(name.data(), &file, sizeof file);
  return memory;
}
const void* opened_on_host(std::int64_t process, const std::array<std::byte, 64>& name, std::size_t bytes) {
  int number = 0;
  std::memcpy(&number, name.data(), sizeof number);
  const std::string path = "/proc/" + std::to_string(process) + "/fd/" + std::to_string(number);
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) return nullptr;
  const void* const memory = locked_memory().of_file(file, bytes);
  close(file);
  return memory;
}

}  // namespace silt
