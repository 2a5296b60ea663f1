#pragma once
// Lines 7 to 12 of Algorithm 1: which bodies touch, or may touch before the step is over, and where.
#include <memory>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/passing.hpp"
#include "rigid/collision/uniform_grid.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

struct ShapeParts;

/// Contacts narrow enough for a lubrication film.
struct LubricationCounts {
  std::uint64_t with = 0, without = 0;
};

/// Keeps only buffers and what follows from the shapes from call to call; the result depends on its arguments
/// alone, and is the same whichever rank finds a contact.
class DetectContacts {
 public:
  explicit DetectContacts(std::unique_ptr<BroadPhase> = std::make_unique<UniformGrid>());
  DetectContacts(DetectContacts&&) noexcept;
  ~DetectContacts();
  /// Fills contacts (sorted by key) with those whose pair this rank owns: exchange.owns_contact_at a point
  /// near both bodies where they are nearest, or deepest in each other. Every point with a gap up to the
  /// pair's margin: how far the surfaces may approach in dt, at most world.contact_margin; at least as far as
  /// a lubrication film reaches where one may form (between a smooth surface and another, a mesh or a
  /// tube). Returns the number of candidate pairs.
  std::size_t operator()(const World&, const BodySet&, const BodyExchange&, CollisionBackend&, double dt,
                         std::vector<Contact>& contacts);
  /// Contacts of the last call within reach of a lubrication film, with and without one. Each contact is
  /// found once.
  LubricationCounts lubrication() const { return lubrication_counts_; }

 private:
  struct Call {  // what a call of operator() works on
    const World& world;
    const BodySet& bodies;
    const BodyExchange& exchange;
    CollisionBackend& backend;
    double dt;
  };
  struct Pair : CandidatePair {
    const Call& call;
    Vec3 from_a_to_b;
    double margin;
  };
  struct Piece {  // a part of a body, or a mesh or tube
    const ShapeParts* of;
    std::size_t index;
    Pose pose;  // in the frame of the query
  };
  void learn_shapes(const World&);
  void set_reach(const World&, const BodySet&, double dt);
  void add_mesh_walls(const Call&);
  Vec3 displacement_to(const Call&, const CandidatePair&) const;
  double pair_margin(const Call&, const CandidatePair&, const Vec3& shift) const;
  bool bodies_apart(const Pair&) const;
  void collide_pair(const Pair&, std::vector<Contact>& contacts);
  static bool pieces_apart(const Piece& a, const Piece& b, double margin);
  void collide_pieces(const Pair&, const Piece& a, const Piece& b);
  Vec3 point_near_both(const Pair&, const ContactPoint&) const;
  static bool may_lubricate(const ShapeParts& a, const ShapeParts& b);
  bool has_lubrication(const ContactPoint&, bool with_mesh) const;
  void put_lubrication(const Pair&, const Piece& a, const Piece& b, const ContactPoint&, Contact&) const;
  static std::uint32_t code_of_a(const Piece& b, const ContactPoint&);
  ReducedRadii radii_of(const Pair&, const Piece& a, const Piece& b, const ContactPoint&) const;
  void let_pass(const Pair&, const Piece& a, const Piece& b, std::span<Contact> of_pieces) const;
  std::optional<Passing> find_passing(const Pair&, const Piece& a, const Piece& b, const ContactPoint&,
                                      double reach) const;

  std::vector<ShapeParts> shapes_;
  bool with_meshes_ = false;
  std::unique_ptr<BroadPhase> broad_phase_;
  double least_margin_ = 0, pull_reach_ = 0;  // of resting contacts, relative to radii; of attraction
  std::vector<Reach> reach_;
  std::vector<BoundingBox> boxes_;  // about the bodies' positions, axis-aligned; of spheres not set
  std::vector<double> turn_;        // how far rotation moves a body's surface in the step
  std::vector<WallSurface> walls_;
  std::vector<CandidatePair> pairs_;
  std::vector<Piece> pieces_of_b_;  // of the pair at work
  std::vector<ContactPoint> points_;
  LubricationCounts lubrication_counts_;
};

}  // namespace silt::rigid
