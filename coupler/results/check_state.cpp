#include "coupler/results/check_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "coupler/case/case.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {

namespace {

using rigid::BodyRecord;

std::string index_fault(const char* name, std::int64_t index, std::size_t count) {
  if (index >= 0 && index < static_cast<std::int64_t>(count)) return "";
  return fmt::format("its {} is {}, and the case has {}", name, index, count);
}

template <std::size_t n>
std::string finite_fault(const char* name, const double (&values)[n]) {
  if (std::all_of(std::begin(values), std::end(values), [](double x) { return std::isfinite(x); })) return "";
  return fmt::format("its {} is not finite", name);
}

std::string turn_fault(const BodyRecord& r) {
  double square = 0;
  for (const double x : r.orientation) square += x * x;
  return std::abs(square - 1) < 1e-6 ? "" : fmt::format("its orientation has the square {}, not 1", square);
}

std::string fault_of(const Case& scene, const BodyRecord& r) {
  if (r.id == 0 || r.id >= rigid::first_wall_id) return "bodies have ids from 1 up to those of the walls";
  if (r.motion > rigid::Motion::asleep)
    return fmt::format("its motion is {}", static_cast<int>(r.motion));
  if (!(r.mass > 0)) return fmt::format("its mass is {}", r.mass);
  for (const std::string& fault :
       {index_fault("shape", r.shape, scene.shapes.size()),
        index_fault("material", r.material, scene.material_names.size()),
        index_fault("kind", r.kind, scene.kind_names.size()), finite_fault("position", r.position),
        finite_fault("velocity", r.velocity), finite_fault("angular velocity", r.angular_velocity),
        finite_fault("angular momentum", r.angular_momentum), turn_fault(r)})
    if (!fault.empty()) return fault;
  return "";
}

}  // namespace

std::string fault_of_bodies(const Case& scene, std::span<const BodyRecord> records) {
  for (const BodyRecord& r : records)
    if (const std::string fault = fault_of(scene, r); !fault.empty())
      return fmt::format("no run can have left body {}: {}", r.id, fault);
  return "";
}

}  // namespace silt::coupler
