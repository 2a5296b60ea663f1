#include "device/exported_memory.hpp"

#include <unistd.h>

#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <new>
#include <string>
#include <utility>

#include "device/host_device.hpp"
#include "device/untouched_pool.hpp"

namespace silt {

namespace cuda {  // gpu.cu
#if defined(SILT_CUDA)
void* exported(std::size_t bytes, std::array<std::byte, 64>& name);
const void* opened(const std::array<std::byte, 64>& name);
#else
void* exported(std::size_t, std::array<std::byte, 64>&) {
  throw std::bad_alloc();
}
const void* opened(const std::array<std::byte, 64>&) {
  return nullptr;
}
#endif
}  // namespace cuda

namespace {

std::uint64_t this_machine() {
  static const std::uint64_t number = [] {
    std::string id;
    std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
    return std::uint64_t(std::hash<std::string>()(id));
  }();
  return number;
}

/// The pieces of memory of one device that this process exports, and those of others that it has opened.
class Pieces final : public std::pmr::memory_resource {
 public:
  explicit Pieces(Device device) : device_(device) {}

  ExportedPlace place_of(const void* at) const {
    const auto& [memory, piece] = *std::prev(mine_.upper_bound(at));
    ExportedPlace place = piece;
    place.offset = std::uint64_t(static_cast<const char*>(at) - static_cast<const char*>(memory));
    return place;
  }
  const void* opened(const ExportedPlace& place) {
    if (place.machine != this_machine()) return nullptr;
    const void*& piece = others_[{place.process, place.piece}];
    if (!piece)
      piece = device_ == Device::gpu ? cuda::opened(place.piece)
                                     : opened_on_host(place.process, place.piece, place.bytes);
    return piece ? static_cast<const char*>(piece) + place.offset : nullptr;
  }

 private:
  void* do_allocate(std::size_t bytes, std::size_t) override {
    if (const auto free = free_.lower_bound(bytes); free != free_.end()) {
      void* const memory = free->second;
      free_.erase(free);
      return memory;
    }
    ExportedPlace piece{this_machine(), getpid(), {}, bytes, 0};
    void* const memory =
        device_ == Device::gpu ? cuda::exported(bytes, piece.piece) : exported_on_host(bytes, piece.piece);
    if (piece.piece == ExportedPlace{}.piece) piece.machine = 0;  // it cannot be exported
    mine_[memory] = piece, others_[{piece.process, piece.piece}] = memory;
    return memory;
  }
  void do_deallocate(void* memory, std::size_t, std::size_t) override {
    free_.emplace(mine_.at(memory).bytes, memory);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  Device device_;
  std::map<const void*, ExportedPlace> mine_;
  std::multimap<std::size_t, void*> free_;
  std::map<std::pair<std::int64_t, std::array<std::byte, 64>>, const void*> others_;
};

Pieces& pieces_of(Device device) {
  static auto* const host = new Pieces(Device::host);  // outlive all arrays
  static auto* const gpu = new Pieces(Device::gpu);
  return device == Device::gpu ? *gpu : *host;
}

}  // namespace

std::pmr::memory_resource* exported_memory(Device device) {
  static auto* const host = new UntouchedPool(&pieces_of(Device::host));
  static auto* const gpu = new UntouchedPool(&pieces_of(Device::gpu));
  return device == Device::gpu ? gpu : host;
}

ExportedPlace place_of(Device device, const void* exported) {
  return pieces_of(device).place_of(exported);
}

const void* opened(Device device, const ExportedPlace& place) {
  return pieces_of(device).opened(place);
}

}  // namespace silt
