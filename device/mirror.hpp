#pragma once
// Arrays shared by the processor and the passes of a device.
#include <cstddef>
#include <memory_resource>
#include <type_traits>
#include <vector>

#include "device/device.hpp"

namespace silt {

/// An array of the processor with a mirror in the device's own memory for its passes. Neither sees changes of
/// the other until the elements are sent or fetched. The device `cpu` has no mirror.
template <class T>
class Mirror {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  explicit Mirror(Device device = Device::cpu) : device_(device) {}
  Mirror(Mirror&&) = default;
  Mirror& operator=(Mirror&&) = default;

  std::pmr::vector<T>& host() { return here_; }
  const std::pmr::vector<T>& host() const { return here_; }
  std::size_t size() const { return here_.size(); }

  /// Returns the elements as passes see them, as they were last sent.
  T* device() { return device_ == Device::cpu ? here_.data() : reinterpret_cast<T*>(there_.data()); }
  const T* device() const { return const_cast<Mirror*>(this)->device(); }
  /// Allocates the mirror for all elements, uninitialised.
  T* make_room() {
    const std::size_t bytes = here_.size() * sizeof(T);
    if (device_ != Device::cpu && there_.size() < bytes)
      there_ = DeviceArray<std::byte>(bytes + bytes / 2, own_memory(device_));
    return device();
  }
  /// Sets all elements to zero on the device only, in order with its passes.
  T* clear() {
    make_room();
    if (!here_.empty()) clear_in_turn(device_, device(), here_.size() * sizeof(T));
    return device();
  }
  /// Copies all elements to the device, in order with its passes. They must not change before that.
  T* send() {
    make_room();
    if (device_ != Device::cpu && !here_.empty()) {
      copy_in_turn(device_, device(), here_.data(), here_.size() * sizeof(T));
      to_device(here_);
    }
    return device();
  }
  /// Copies all elements from the device, in order with its passes; they are valid once these have finished.
  void fetch() {
    if (device_ == Device::cpu || here_.empty()) return;
    copy_in_turn(device_, here_.data(), device(), here_.size() * sizeof(T));
    from_device(here_);
  }

 private:
  Device device_;
  std::pmr::vector<T> here_{message_memory(device_)};
  DeviceArray<std::byte> there_{own_memory(device_)};  // accessible to the device only
};

}  // namespace silt
