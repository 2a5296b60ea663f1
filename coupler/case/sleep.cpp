#include "coupler/case/sleep.hpp"

#include <algorithm>
#include <cmath>

namespace silt::coupler {

std::optional<rigid::SleepRule> sleep_rule(const Case& scene) {
  constexpr double share_of_gravity = 1e-3, longest = 1e9;
  const ContactSpec& contacts = scene.contacts;
  if (!contacts.sleep_speed) return std::nullopt;
  const double gravity = scene.gravity.norm();
  const double time = contacts.sleep_time ? *contacts.sleep_time
                      : gravity > 0       ? *contacts.sleep_speed / (share_of_gravity * gravity)
                                          : longest;
  return rigid::SleepRule{*contacts.sleep_speed, int(std::clamp(std::ceil(time), 1.0, longest))};
}

}  // namespace silt::coupler
