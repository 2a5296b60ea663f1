#pragma once
// Everything a run holds, built from a case: the domain, the bodies and the world they live in, the exchange
// between ranks, and those parts of the step the scene needs. What it does not need is not there (null).
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
#include "rigid/rigid_step.hpp"
#include "silt/load_balance.hpp"
#include "silt/placement/place_bodies.hpp"

namespace silt {

struct BodySpec;
struct Case;
struct CentredShape;

/// Returns the levels of cells in a part of the domain, as boxes; collective.
using SavedLevels = std::function<std::vector<lbm::LevelBox>(const lbm::CellBox& part)>;

class Scene {
  std::shared_ptr<const Case> own_setup_;

 public:
  /// Collective. The case must have passed check_case; CaseError on every rank if a fill does not fit. With
  /// `saved` the bodies are those, each of them saved on exactly one rank, whichever, instead of the case's,
  /// and the levels of cells those saved. With a first id those of the case are there as well, from it on.
  /// std::invalid_argument for a domain that cannot be cut for this many ranks, or an unknown backend or
  /// resolver. The flow is at rest and not started.
  Scene(Case, MPI_Comm, const coupler::SavedBodies* saved = nullptr, const SavedLevels& = {},
        rigid::BodyId first_id = 0);

  const Case& setup;
  MPI_Comm comm;
  int rank = 0, ranks = 1;
  lbm::Domain domain;
  rigid::World world;
  rigid::BodySet bodies;        // this rank's
  bool anything_moves = false;  // a body that is not fixed, on any rank, or may come
  struct AtStart {
    std::uint64_t body_count = 0;     // of all ranks
    rigid::BodyId first_free_id = 1;  // none of the case's bodies has that or a higher one
    StartPositions positions;         // of the case's bodies
    Evenness evenness;                // of the work of ranks, under the equal cut and the one taken
  } at_start;                         // of this run
  std::unique_ptr<coupler::ParallelBodyExchange> exchange;
  struct {
    std::unique_ptr<rigid::CollisionBackend> backend;
    std::unique_ptr<rigid::ContactResolver> resolver;
  } contacts;  // this and the step: null if no body moves
  std::unique_ptr<rigid::RigidStep> rigid_step;
  std::unique_ptr<coupler::Flow> flow;        // null: no [fluid]
  std::unique_ptr<coupler::Springs> springs;  // null: no [[springs]]

  /// Gives walls that move the pose and the velocities that they have after so many steps, and the pose at
  /// which the next step maps them: functions of the step alone.
  void move_walls(std::int64_t step);

  /// Gives gravity, moving sides, bodies, springs and the flow what drives them in the step that follows so
  /// many.
  void drive(std::int64_t steps_done);

  /// Says whether the domain may be cut as the work is shared best.
  bool may_be_cut_again() const;
  /// Collective, between steps, once the flow has started: goes over to another cut, of a leaf a rank or
  /// more. Bodies and populations move to the ranks it gives; the flow and the parts that refer to it are new
  /// ones.
  void repartition(const lbm::CutTree&);

  /// Changes to the levels of cells that follow from where bodies and walls are now; between steps of the
  /// coarsest cells, once the flow has started. Ranks that see no change do nothing. Returns whether this one
  /// did anything.
  bool regrid();
  /// Returns the levels of the cells that this rank knows of; needs [coarsening].
  const lbm::Domain& level_view() const { return *level_view_; }
  /// Says whether this rank knows of cells, other than finest ones, that are nearer to a box than bodies may
  /// ever be; needs [coarsening].
  bool has_coarser_cells_near(const rigid::BoundingBox&) const;
  std::optional<rigid::BodyId> body_at_border() const;

  /// Makes a row that of a body which a case places: wrapped into the domain, at rest on the lattice.
  void set_placed(std::size_t row, rigid::BodyId, const BodySpec&, const CentredShape&);

  std::string backend_name() const {
    return contacts.backend ? std::string(contacts.backend->name()) : "none";
  }
  std::string resolver_name() const {
    return contacts.resolver ? std::string(contacts.resolver->name()) : "none";
  }
  /// The passes of a coupled step for this scene.
  coupler::SceneParts parts();

 private:
  void take_saved_bodies(const coupler::SavedBodies&);
  void take_placed_bodies(const std::vector<CentredShape>&, rigid::BodyId first_id);
  void count_bodies();
  void cut_for_bodies();
  void apply_cut(const lbm::CutTree&);
  void update_level_view();
  void renew_flow();

  struct MovingWall {
    std::size_t number;  // in the case
    coupler::WallMapping mapping;
  };
  std::vector<MovingWall> moving_walls_;
  std::unique_ptr<coupler::LevelViews> level_views_;  // null: no [coarsening]
  std::optional<lbm::Domain> level_view_;
};

}  // namespace silt
