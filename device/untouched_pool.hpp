#pragma once
// A memory pool for device memory that the processor must not, or should not, touch.
#include <algorithm>
#include <bit>
#include <cstddef>
#include <memory_resource>
#include <vector>

namespace silt {

/// Allocations from a device are slow and take whole pages, while lists are many and small. This pool divides
/// large allocations into blocks of powers of two without touching them: a page of managed memory that the
/// processor writes would leave the card. It never returns memory to the device.
class UntouchedPool final : public std::pmr::memory_resource {
 public:
  explicit UntouchedPool(std::pmr::memory_resource* device) : device_(device) {}

 private:
  static constexpr std::size_t least = 256, most = std::size_t{1} << 22,
                               chunk = std::size_t{1} << 25;  // bytes
  static int size_class(std::size_t bytes) { return std::bit_width((std::max(bytes, least) - 1) / least); }

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (bytes > most) return device_->allocate(bytes, alignment);
    const std::size_t size = least << size_class(bytes);
    std::vector<void*>& free = free_[size_class(bytes)];
    if (free.empty()) {
      if (left_ < size) next_ = static_cast<char*>(device_->allocate(chunk)), left_ = chunk;
      free.push_back(next_);
      next_ += size, left_ -= size;
    }
    void* const memory = free.back();
    free.pop_back();
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    if (bytes > most) return device_->deallocate(memory, bytes, alignment);
    free_[size_class(bytes)].push_back(memory);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  std::pmr::memory_resource* device_;
  std::vector<void*> free_[16];
  char* next_ = nullptr;
  std::size_t left_ = 0;  // bytes
};

}  // namespace silt
