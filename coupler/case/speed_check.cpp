#include "coupler/case/speed_check.hpp"

#include <fmt/format.h>

#include "coupler/case/case.hpp"
#include "coupler/case/time_step_cure.hpp"

namespace silt::coupler {

std::string in_metres_a_second(const Case& scene, double speed) {
  if (!scene.units.si) return "";
  return fmt::format(" ({} m/s)", shown(scene.units.physical(speed, dimension::velocity)));
}

void check_speed(Findings& findings, const std::string& key, double speed) {
  if (speed <= doubtful_velocity) return;
  const Case& scene = findings.scene;
  const std::string found =
      fmt::format("{} is {} cells a step{}", key, shown(speed), in_metres_a_second(scene, speed));
  const std::string cure = scene.units.si ? time_step_cure(scene, doubtful_velocity / speed) + ", or lower it"
                                          : fmt::format("lower it to {}", doubtful_velocity);
  if (!(speed <= impossible_velocity))
    findings.error(key, fmt::format("{}; it must be at most {}: {}", found, impossible_velocity, cure));
  else
    findings.warning(key, fmt::format("{}; above {} the fluid is noticeably compressible: {}", found,
                                      doubtful_velocity, cure));
}

}  // namespace silt::coupler
