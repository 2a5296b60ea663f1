#include "silt/scene.hpp"

#include <algorithm>
#include <cmath>

#include "adapters/automatic/collision_factory.hpp"
#include "coupler/exchange/coupling_state.hpp"
#include "coupler/forces/entrained_fluid.hpp"
#include "coupler/forces/lubrication.hpp"
#include "coupler/mapping/solid_map.hpp"
#include "parallel/collectives.hpp"
#include "rigid/bodies/walls.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case.hpp"
#include "silt/case/case_check.hpp"
#include "silt/placement/place_bodies.hpp"

namespace silt {
namespace {

using rigid::Vec3;

// Cells by which blocks are grown to find the holders of a body in a fluid: the ghost layers of the solid map
// (cell centres are at most 1.5 cells away; the rest allows for mapping poses that lag behind). The guard's
// limit of motion in a step is added.
constexpr double ghost_layers = coupler::CellBits::ghosts;
// Without a fluid: the distance by which rounding may move a contact point into another block.
constexpr double dry_slack = 1e-3;

double rim_of(const Case& setup) {
  double margin = setup.contacts.margin;
  for (const rigid::Material& material : setup.pair_materials)
    margin = std::max(margin, material.van_der_waals_reach());
  return margin / 2 + (setup.fluid ? ghost_layers + furthest_motion : margin / 2 + dry_slack);
}

rigid::World make_world(const Case& setup, const std::vector<CentredShape>& shapes) {
  rigid::World world;
  for (const CentredShape& s : shapes) {
    world.shapes.push_back(s.shape);
    world.bounding_radii.push_back(s.bounding_radius);
  }
  world.materials = setup.pair_materials;
  world.material_count = static_cast<int>(setup.material_names.size());
  world.gravity = setup.gravity;
  world.contact_margin = setup.contacts.margin;
  if (setup.has_lubrication()) world.lubrication = make_lubrication(*setup.fluid, setup.coupling);
  return world;
}

/// Adds the material of free-slip sides, and returns it: the default one, but without friction, since a body
/// and its mirror image do not slide on one another.
int add_smooth_material(rigid::World& world) {
  const int smooth = world.material_count++;
  const std::vector<rigid::Material> given = std::move(world.materials);
  world.materials.clear();
  for (int i = 0; i <= smooth; ++i)
    for (int j = 0; j <= smooth; ++j) {
      rigid::Material pair = given[(i % smooth) * smooth + j % smooth];
      if (i == smooth || j == smooth) pair.friction = pair.twisting_friction = 0;
      world.materials.push_back(pair);
    }
  return smooth;
}

std::array<rigid::WallSpec, 6> walls_of(const Case& setup, rigid::World& world) {
  std::array<rigid::WallSpec, 6> walls;
  int smooth = 0;
  for (int side = 0; side < 6; ++side) {
    const coupler::BoundarySpec& boundary = setup.boundary[side];
    walls[side].solid = boundary.stops_bodies();
    if (boundary.is_wall()) walls[side].velocity = boundary.velocity;
    if (boundary.kind != coupler::BoundaryKind::free_slip) continue;
    if (smooth == 0) smooth = add_smooth_material(world);
    walls[side].material = smooth;
    walls[side].mirrors = true;
  }
  return walls;
}

/// Returns the wall with its axis point, about which torques are summed, nearest to the domain's middle.
rigid::TubeWallSpec at_the_domain(rigid::TubeWallSpec wall, const rigid::Extent& extent) {
  wall.point += wall.axis.dot(0.5 * extent.size - wall.point) * wall.axis;
  return wall;
}

}  // namespace

Scene::Scene(Case given, MPI_Comm communicator, const coupler::SavedBodies* saved, const SavedLevels& levels,
             rigid::BodyId first_id)
    : own_setup_(std::make_shared<const Case>(std::move(given))),
      setup(*own_setup_),
      comm(communicator),
      domain(coupler::make_domain(setup, ranks())) {
  const auto shapes = centred_shapes(setup);
  bodies.locked_of_kind = setup.kind_locks;
  world = make_world(setup, shapes);
  if (saved) take_saved_bodies(*saved);
  if (!saved || first_id > 0) take_placed_bodies(shapes, std::max<rigid::BodyId>(first_id, 1));
  count_bodies();
  if (setup.has_bodies()) rigid::add_walls(bodies, world, extent_of(setup), walls_of(setup, world));
  for (std::size_t k = 0; k < setup.walls.size(); ++k) {
    if (const MeshWall* mesh = setup.walls[k].mesh()) {
      rigid::add_wall(bodies, world, *mesh);
      if (mesh->motion.moves()) moving_walls_.push_back({k, {*mesh, setup.coupling.remap_tolerance}});
    } else {
      rigid::add_wall(bodies, world, at_the_domain(*setup.walls[k].tube(), extent_of(setup)));
    }
  }
  for (std::size_t row = bodies.first_wall(); row < bodies.size(); ++row)
    coupler::set_mapping_pose(bodies, row, bodies.pose(row));
  move_walls(0);
  exchange = std::make_unique<coupler::ParallelBodyExchange>(comm, domain, world, rim_of(setup));
  exchange->synchronise(bodies);
  update_level_view();
  if (may_be_cut_again()) cut_for_bodies();
  if (anything_moves) {
    contacts.backend = adapters::make_backend(setup.contacts.backend);
    rigid::ResolverSettings settings = setup.contacts.resolver_settings;
    rigid::set_materials(settings, world);
    if (setup.fluid) settings.impacts = std::make_shared<coupler::EntrainedFluid>();
    contacts.resolver = rigid::make_resolver(setup.contacts.resolver, settings);
    rigid_step =
        std::make_unique<rigid::RigidStep>(world, *contacts.backend, *contacts.resolver, *exchange,
                                           adapters::make_broad_phase("auto", setup.contacts.backend));
  }
  if (!setup.springs.empty()) {
    std::vector<rigid::Motion> motions;
    for (const BodySpec& body : setup.bodies) motions.push_back(body.motion);
    springs = std::make_unique<coupler::Springs>(setup.springs, motions, extent_of(setup), comm);
  }
  if (levels)
    levels_.view = lbm::Domain(levels_.views->view(levels(levels_.views->part())), domain.sides(), ranks());
  if (setup.fluid) flow = new_flow();
}

/// Updates the levels of cells from the places of bodies and walls.
void Scene::update_level_view() {
  if (!setup.coarsening) return;
  if (!levels_.views)
    levels_.views =
        std::make_unique<coupler::LevelViews>(setup, entrances_of(setup), domain.tree(), world, comm);
  levels_.view = lbm::Domain(levels_.views->view(bodies), domain.sides(), ranks());
}

void Scene::move_walls(std::int64_t step) {
  const std::size_t first = bodies.size() - setup.walls.size();
  for (const MovingWall& wall : moving_walls_) {
    const std::size_t row = first + wall.number;
    rigid::move_wall(bodies, row, *setup.walls[wall.number].mesh(), static_cast<double>(step));
    coupler::set_mapping_pose(bodies, row, wall.mapping.pose(step));
  }
}

void Scene::drive(std::int64_t step) {
  const double middle = static_cast<double>(step) + 0.5;  // of the step
  world.gravity = setup.gravity_at(middle);
  for (int side = 0; side < 6; ++side) {
    const coupler::BoundarySpec& of = setup.boundary[side];
    if (!of.is_wall() || !of.over_time.varies()) continue;
    const std::size_t row = bodies.row_of(rigid::first_wall_id + side);
    if (row < bodies.size()) bodies.set_velocity(row, of.velocity_at(middle), Vec3::Zero());
  }
  for (std::size_t row = 0; row < bodies.owned && !setup.kind_motions.empty(); ++row) {
    const auto found = setup.kind_motions.find(bodies.kind[row]);
    if (found == setup.kind_motions.end() || bodies.motion[row] != rigid::Motion::prescribed) continue;
    const auto velocity = found->second.over_step(static_cast<double>(step));
    bodies.set_velocity(row, velocity.linear, velocity.angular);
  }
  if (!setup.kind_motions.empty()) exchange->synchronise(bodies);  // their holders may have changed
  if (springs) {
    if (step == 0) springs->start(bodies);
    springs->share(bodies);
  }
  if (flow) flow->drive(step);
}

bool Scene::may_be_cut_again() const {
  return ranks() > 1 && !setup.block_cells;
}

/// Changes from the equal cut to one for the predicted work of bodies, if that is clearly better.
void Scene::cut_for_bodies() {
  constexpr double clearly = 0.05;  // in units of the mean work of a rank
  const CutComparison cuts = compare_cuts(*this);
  Evenness& evenness = at_start.evenness;
  evenness.before = evenness.after = cuts.present.largest_over_mean();
  if (cuts.present.largest_over_mean() - cuts.better.largest_over_mean() <= clearly) return;
  evenness.after = cuts.better.largest_over_mean();
  apply_cut(cuts.better.tree);
}

void Scene::apply_cut(const lbm::CutTree& tree) {
  domain = lbm::Domain(tree, domain.sides(), ranks());
  exchange->repartition(bodies);
  levels_.views.reset();
  update_level_view();
}

void Scene::repartition(const lbm::CutTree& tree) {
  apply_cut(tree);
  if (flow) renew_flow();
}

std::unique_ptr<coupler::Flow> Scene::new_flow() const {
  return coupler::make_flow(setup, levels_.view ? *levels_.view : domain, comm, *exchange,
                            setup.contacts.substeps, flow.get());
}

void Scene::renew_flow() {
  auto moved = new_flow();
  moved->take_over(*flow);
  flow = std::move(moved);
  flow->start(bodies);
}

bool Scene::has_coarser_cells_near(const rigid::BoundingBox& box) const {
  const double margin = coupler::least_margin(setup.coupling);
  for (int level = 1; level < flow->levels(); ++level) {
    const double width = 1 << level;
    lbm::CellBox cells;
    for (int d = 0; d < 3; ++d) {
      cells.lower[d] = int(std::floor((box.lower[d] - margin) / width));
      cells.size[d] = int(std::ceil((box.upper[d] + margin) / width)) - cells.lower[d];
    }
    if (!flow->fields(level).domain().blocks_meeting(cells).empty()) return true;
  }
  return false;
}

/// Returns a body of this rank that is too close to coarser cells.
std::optional<rigid::BodyId> Scene::body_at_border() const {
  for (std::size_t row = 0; row < bodies.owned; ++row)
    if (has_coarser_cells_near(rigid::bounding_box(world.shapes[bodies.shape[row]], bodies.pose(row))))
      return bodies.id[row];
  return {};
}

bool Scene::regrid() {
  update_level_view();
  bool changed = levels_.view->tree() != flow->fields().domain().tree();
  // A flow on a device is made by all ranks together (SlotExchange), whether they see the change or not.
  if (setup.device != Device::cpu) changed = parallel::max_over_ranks(comm, double(changed)) > 0;
  if (!changed) return false;
  renew_flow();
  return true;
}

void Scene::take_saved_bodies(const coupler::SavedBodies& saved) {
  parallel::Messages messages(comm);
  distribute_to_owners(messages, coupler::Holders(domain, 0), saved, bodies);
}

void Scene::take_placed_bodies(const std::vector<CentredShape>& shapes, rigid::BodyId first_id) {
  require_sound_start(setup, domain, comm);
  const PlacedBodies placed = place_bodies(setup, domain, comm, &bodies);
  at_start.first_free_id = placed.next_id + first_id - 1;
  std::size_t row = bodies.owned;
  bodies.resize(row + placed.size());
  bodies.owned += placed.size();
  placed.for_each([&](rigid::BodyId id, const BodySpec& body) {
    set_placed(row++, id + first_id - 1, body, shapes[body.shape]);
  });
  bodies.reindex();
}

void Scene::set_placed(std::size_t row, rigid::BodyId id, const BodySpec& body, const CentredShape& shape) {
  bodies.assign(row, body_record(id, body, shape, setup.fluid.has_value()));
  extent_of(setup).wrap(bodies.position[row], bodies.image[row]);
  bodies.set_velocity(row, bodies.velocity[row], bodies.angular_velocity[row]);
  coupler::set_mapping_pose(bodies, row, bodies.pose(row));
  if (setup.heat) coupler::coupling_of(bodies, row).temperature.numbers[0] = setup.heat->at_start(body.kind);
}

void Scene::count_bodies() {
  const auto first = bodies.motion.begin(), last = first + static_cast<std::ptrdiff_t>(bodies.owned);
  struct Counts {
    std::uint64_t bodies, ranks_where_one_moves;
  };
  const auto counts = parallel::sum_over_ranks(
      comm, Counts{bodies.owned,
                   std::any_of(first, last, [](rigid::Motion m) { return m != rigid::Motion::fixed; })});
  at_start.body_count = counts.bodies;
  anything_moves = counts.ranks_where_one_moves > 0 || setup.bodies_come();
}

coupler::SceneParts Scene::parts() {
  return {flow.get(), springs.get(), rigid_step.get(), setup.contacts.substeps, setup.has_surfaces()};
}

}  // namespace silt
