#pragma once
// The parts of a run, built from a case: domain, bodies, world, the exchange between ranks, and those parts
// of a step that the scene needs; others are null.
#include <mpi.h>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coupler/coupled_step.hpp"
#include "coupler/exchange/parallel_body_exchange.hpp"
#include "coupler/flow.hpp"
#include "coupler/forces/springs.hpp"
#include "coupler/mapping/mapping_poses.hpp"
#include "coupler/regions/level_views.hpp"
#include "parallel/communicator.hpp"
#include "rigid/rigid_step.hpp"
#include "silt/load_balance.hpp"
#include "silt/placement/place_bodies.hpp"

namespace silt {

struct BodySpec;
struct Case;
struct CentredShape;

/// Returns the boxes of cells of one level in a part of the domain. Collective.
using SavedLevels = std::function<std::vector<lbm::LevelBox>(const lbm::CellBox& part)>;

class Scene {
  std::shared_ptr<const Case> own_setup_;

 public:
  /// The case must have passed check_case. With `saved` the scene has these bodies, each saved on exactly one
  /// rank, instead of the case's, and the saved levels of cells; with a first id also those of the case, from
  /// this id on. The flow is at rest and not started. Collective. Throws on every rank: CaseError if given
  /// bodies overlap or a fill does not fit, std::invalid_argument for a domain that cannot be cut for this
  /// number of ranks, or an unknown backend or resolver.
  Scene(Case, MPI_Comm, const coupler::SavedBodies* saved = nullptr, const SavedLevels& = {},
        rigid::BodyId first_id = 0);

  const Case& setup;
  MPI_Comm comm;
  lbm::Domain domain;
  rigid::World world;
  rigid::BodySet bodies;        // of this rank
  bool anything_moves = false;  // any rank has a body that is not fixed, or bodies may arrive
  struct AtStart {
    std::uint64_t body_count = 0;     // of all ranks
    rigid::BodyId first_free_id = 1;  // above all ids of the case's bodies
    StartPositions positions;         // of the case's bodies
    Evenness evenness;                // of the work, with the equal cut and with the chosen one
  } at_start;                         // of this run
  std::unique_ptr<coupler::ParallelBodyExchange> exchange;
  struct {
    std::unique_ptr<rigid::CollisionBackend> backend;
    std::unique_ptr<rigid::ContactResolver> resolver;
  } contacts;  // null, like rigid_step, if no body moves
  std::unique_ptr<rigid::RigidStep> rigid_step;
  std::unique_ptr<coupler::Flow> flow;        // null: no [fluid]
  std::unique_ptr<coupler::Springs> springs;  // null: no [[springs]]

  int rank() const { return parallel::rank_of(comm); }
  int ranks() const { return parallel::ranks_of(comm); }

  /// Sets moving walls to pose and velocities after `step` steps, and to the next mapping pose.
  void move_walls(std::int64_t step);

  /// Sets what drives step `steps_done + 1`: gravity, moving sides, bodies, springs and the flow.
  void drive(std::int64_t steps_done);

  /// Returns whether the domain may be cut again for load balance.
  bool may_be_cut_again() const;
  /// Changes to another cut with at least one leaf per rank: moves bodies and populations, and makes the flow
  /// and the parts that refer to it anew. Call between steps, after the flow has started. Collective.
  void repartition(const lbm::CutTree&);

  /// Updates the levels of cells for the present places of bodies and walls; returns whether this rank
  /// changed anything. Call between steps of the coarsest cells, after the flow has started.
  bool regrid();
  /// Returns the levels of the cells known to this rank; needs [coarsening].
  const lbm::Domain& level_view() const { return *levels_.view; }
  /// Returns whether this rank knows of coarser cells closer to a box than bodies may be; needs [coarsening].
  bool has_coarser_cells_near(const rigid::BoundingBox&) const;
  std::optional<rigid::BodyId> body_at_border() const;

  /// Sets a row to a body placed by the case: wrapped into the domain, mapped at its pose, at rest.
  void set_placed(std::size_t row, rigid::BodyId, const BodySpec&, const CentredShape&);

  std::string backend_name() const {
    return contacts.backend ? std::string(contacts.backend->name()) : "none";
  }
  std::string resolver_name() const {
    return contacts.resolver ? std::string(contacts.resolver->name()) : "none";
  }
  /// Returns the parts for a coupled step.
  coupler::SceneParts parts();

 private:
  void take_saved_bodies(const coupler::SavedBodies&);
  void take_placed_bodies(const std::vector<CentredShape>&, rigid::BodyId first_id);
  void count_bodies();
  void cut_for_bodies();
  void apply_cut(const lbm::CutTree&);
  void update_level_view();
  std::unique_ptr<coupler::Flow> new_flow() const;
  void renew_flow();

  struct MovingWall {
    std::size_t number;  // index in the case
    coupler::WallMapping mapping;
  };
  std::vector<MovingWall> moving_walls_;
  struct {
    std::unique_ptr<coupler::LevelViews> views;
    std::optional<lbm::Domain> view;  // the present one
  } levels_;                          // null: no [coarsening]
};

/// A start from rest without sound waves (method-coupling.md, equation 55). Loads on bodies and fluid act at
/// once, but the fluid's pressure responds with the speed of sound and oscillates. This function builds up
/// the pressure before the first step, over quiet_start_steps() of the case: loads act, bodies keep their
/// places, and fluid and bodies are repeatedly brought to rest. Nothing changes but the pressure. Call it
/// when the flow has started and is driven. Collective.
void start_quietly(Scene&);

}  // namespace silt
