#pragma once
// Arrays that the processor and the passes of a device pass to one another.
#include <algorithm>
#include <cstddef>
#include <memory_resource>
#include <type_traits>
#include <vector>

#include "device/device.hpp"

namespace silt {

/// An array of the processor, and its mirror where the passes of a device read and write it. Neither sees
/// what the other one does until the elements are sent or fetched. The device `cpu` has no mirror: its passes
/// are the processor's own.
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

  /// Returns where passes find the elements as they were sent last.
  T* device() { return device_ == Device::cpu ? here_.data() : reinterpret_cast<T*>(there_.data()); }
  const T* device() const { return const_cast<Mirror*>(this)->device(); }
  /// Makes room for as many elements as there are here, of any value.
  T* make_room() {
    const std::size_t bytes = here_.size() * sizeof(T);
    if (device_ != Device::cpu && there_.size() < bytes)
      there_ = DeviceArray<std::byte>(bytes + bytes / 2, own_memory(device_));
    return device();
  }
  /// Sets all elements to zero on the device alone, in turn with its passes.
  T* clear() {
    make_room();
    if (device_ == Device::cpu)
      std::fill(here_.begin(), here_.end(), T{});
    else if (!here_.empty())
      clear_in_turn(device_, device(), here_.size() * sizeof(T));
    return device();
  }
  /// Sends all elements in turn with the passes of the device. They stay as they are until these are done.
  T* send() {
    make_room();
    if (device_ != Device::cpu && !here_.empty()) {
      copy_in_turn(device_, device(), here_.data(), here_.size() * sizeof(T));
      to_device(here_);
    }
    return device();
  }
  /// Brings all elements in turn with the passes of the device: they are here once these are done.
  void fetch() {
    if (device_ == Device::cpu || here_.empty()) return;
    copy_in_turn(device_, here_.data(), device(), here_.size() * sizeof(T));
    from_device(here_);
  }

 private:
  Device device_;
  std::pmr::vector<T> here_{message_memory(device_)};
  DeviceArray<std::byte> there_{own_memory(device_)};  // which only the device may touch
};

}  // namespace silt
