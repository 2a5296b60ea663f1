// Keys that do nothing in this case, since what another section says switches them off. What keys of one
// table do to each other its reader says.
#include <fmt/format.h>

#include <algorithm>

#include "silt/case/case_sections.hpp"
#include "silt/case/quiet_start_steps.hpp"

namespace silt {
namespace {

constexpr const char* no_free_bodies = "no body of the case is free to move; remove it";

/// Says whether cells change sides: surfaces move over them.
bool has_moving_surfaces(const Case& setup) {
  const auto moves = [](const BodySpec& body) { return body.motion != rigid::Motion::fixed; };
  const auto mesh_moves = [](const CurvedWall& wall) { return wall.mesh() && wall.moves(); };
  return !setup.fills.empty() || setup.any_given(moves) || std::ranges::any_of(setup.continued, moves) ||
         std::ranges::any_of(setup.walls, mesh_moves);
}

void find_idle_keys_of_fluid(const Case& setup, Diagnostics& findings) {
  if (!setup.fluid) {
    if (setup.device != Device::cpu)
      findings.idle("run.device", "the case has no [fluid], whose passes it is about; remove it");
    return;
  }
  const coupler::FluidSpec& fluid = *setup.fluid;
  if (fluid.quiet_start && quiet_start_steps(setup) == 0)
    findings.idle("fluid.quiet_start",
                  begins_at_rest(setup)
                      ? "neither weights nor springs nor a body force push anything at the start; remove it"
                      : "the case does not begin at rest; remove it, or what moves the fluid at the start");
  if (fluid.body_force_on_bodies && fluid.has_body_force() && !setup.has_free_bodies())
    findings.idle("fluid.body_force_on_bodies", no_free_bodies);
}

void find_idle_keys_of_coupling(const Case& setup, Diagnostics& findings) {
  if (!setup.fluid) return;
  if (!setup.has_surfaces())
    return findings.idle("coupling", "there are no bodies and no [[walls]] in the fluid; remove it");
  if (!has_moving_surfaces(setup))
    findings.idle("coupling.remap_tolerance", "no body and no mesh of [[walls]] moves; remove it");
  if (setup.has_free_bodies()) return;
  for (const char* key : {"coupling.time", "coupling.lubrication", "coupling.lubrication_min_gap"})
    findings.idle(key, no_free_bodies);
}

void find_idle_keys_of_bodies(const Case& setup, Diagnostics& findings) {
  const auto has_weight = [&](const Entry& entry) {
    return entry.is_free() && (!setup.fluid || entry.density != 1);
  };
  if (!setup.gravity.isZero(0) && !setup.start && std::ranges::none_of(entries_of(setup), has_weight))
    findings.idle("gravity", setup.has_free_bodies()
                                 ? "all free bodies are as heavy as the fluid"
                                 : "it acts on free bodies, and the case has none; a pressure "
                                   "gradient is fluid.body_force");
  if (setup.has_free_bodies()) return;
  for (const char* key : {"contacts", "material_pairs"})
    findings.idle(key, "contacts move free bodies, and the case has none; remove it");
  for (const auto& [path, place] : setup.places)
    if (path.ends_with(".material")) findings.idle(path, no_free_bodies);
  if (setup.has_bodies()) return;
  for (const auto& [path, place] : setup.places)
    if (path.starts_with("domain.boundary") && path.ends_with(".solid_for_bodies"))
      findings.idle(path, "the case has no bodies; remove it");
}

/// The axis of a wall and its point are of its rotation, and of torques on it.
void find_idle_keys_of_walls(const Case& setup, Diagnostics& findings) {
  for (std::size_t i = 0; i < setup.walls.size(); ++i) {
    const MeshWall* const mesh = setup.walls[i].mesh();
    const auto is_of_its_torque = [&](const QuantitySpec& q) {
      return q.wall == int(i) && q.type.ends_with("torque") &&
             (q.bearer == Bearer::wall || quantity_type(q.type).takes(QuantityType::wall));
    };
    if (!mesh || std::ranges::any_of(setup.quantities, is_of_its_torque)) continue;
    const std::string motion = fmt::format("walls[{}].motion", i);
    const bool turns = !mesh->motion.angular_velocity.isZero(0);
    if (!turns) findings.idle(motion + ".axis", "the wall does not turn about it; give angular_velocity");
    if (!turns && mesh->table.empty())
      findings.idle(motion + ".point", "the wall does not turn about it; give angular_velocity");
  }
}

void find_idle_keys_of_run(const Case& setup, Diagnostics& findings) {
  if (setup.balance_every > 0 && setup.block_cells)
    findings.idle("run.balance", "domain.blocks says how the domain is cut; remove one of them");
  if (!setup.coarsening) return;
  const auto covers_all = [&](const coupler::FineBox& fine) {
    return fine.level == 0 && fine.box.lower.maxCoeff() <= 0 &&
           (fine.box.upper - extent_of(setup).size).minCoeff() >= 0;
  };
  if (std::ranges::any_of(setup.coarsening->fine, covers_all))
    return findings.idle("coarsening", "a box of coarsening.fine keeps all cells finest; remove one of them");
  if (!setup.has_surfaces() && (setup.coarsening->levels == 1 || setup.coarsening->fine.empty()))
    findings.idle("coarsening.distance", "there are no bodies and no [[walls]] that it is from");
}

}  // namespace

void find_idle_keys(const Case& setup, Diagnostics& findings) {
  find_idle_keys_of_fluid(setup, findings);
  find_idle_keys_of_coupling(setup, findings);
  find_idle_keys_of_bodies(setup, findings);
  find_idle_keys_of_walls(setup, findings);
  find_idle_keys_of_run(setup, findings);
}

}  // namespace silt
