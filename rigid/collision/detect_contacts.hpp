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
#include "rigid/shapes/bounding_box.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

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
  /// hollow). Returns the number of candidate pairs.
  std::size_t operator()(const World&, const BodySet&, const BodyExchange&, CollisionBackend&, double dt,
                         std::vector<Contact>& contacts);
  /// Contacts of the last call within reach of a lubrication film, with and without one. Each contact is
  /// found once.
  LubricationCounts lubrication() const { return lubrication_counts_; }

 private:
  struct ShapeParts;
  struct Call {  // what a call of operator() works on
    const World& world;
    const BodySet& bodies;
    const BodyExchange& exchange;
    CollisionBackend& backend;
    double dt;
  };
  struct Piece {  // a part of a body, or a mesh or hollow
    const ShapeParts& of;
    std::size_t index;
    const Pose& pose;  // in the frame of the query
  };
  void learn_shapes(const World&);
  void set_reach(const World&, const BodySet&, double dt);
  double pair_margin(const World&, const BodySet&, const CandidatePair&, const Vec3& shift, double dt) const;
  Vec3 point_near_both(const BodySet&, const CandidatePair&, const ContactPoint&) const;
  void add_mesh_walls(const Call&);
  bool bodies_apart(const BodySet&, const CandidatePair&, const Vec3& from_a_to_b, double margin) const;
  Vec3 displacement_to(const BodySet&, const Extent&, const CandidatePair&) const;
  void collide_pieces(const Piece& a, const Piece& b, double margin, CollisionBackend&);
  void collide_meshes(const Piece& a, const Piece& b, double margin, CollisionBackend&);
  void collide_pair(const Call&, const CandidatePair&, const Vec3& from_a_to_b, double margin,
                    std::vector<Contact>& contacts);
  static bool may_lubricate(const ShapeParts& a, const ShapeParts& b);
  bool has_lubrication(const ContactPoint&, bool with_mesh) const;
  void put_lubrication(const Call&, const CandidatePair&, const Piece& a, const Piece& b, const ContactPoint&,
                       Contact&) const;
  void let_pass(const Call&, const CandidatePair&, const Piece& a, const Piece& b, const Vec3& from_a_to_b,
                std::span<Contact> of_pieces) const;
  std::optional<Passing> find_passing(const Call&, const CandidatePair&, const Piece& a, const Piece& b,
                                      const Vec3& from_a_to_b, const ContactPoint&, double reach) const;
  void count_lubrication(const LubricationLaw&, std::span<const Contact>);
  bool parts_apart(const ShapeParts& a, std::size_t i, const Pose& pose_a, const ShapeParts& b, std::size_t j,
                   const Pose& pose_b, double margin) const;

  std::vector<ShapeParts> shapes_;
  bool with_meshes_ = false;
  std::unique_ptr<BroadPhase> broad_phase_;
  std::vector<Reach> reach_;
  std::vector<BoundingBox> boxes_;  // about the bodies' positions, axis-aligned; of spheres not set
  std::vector<double> turn_;        // how far rotation moves a body's surface in the step
  std::vector<WallSurface> walls_;
  std::vector<CandidatePair> pairs_;
  std::vector<ContactPoint> points_;
  LubricationCounts lubrication_counts_;
};

}  // namespace silt::rigid
