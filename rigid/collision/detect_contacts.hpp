#pragma once
// Contact detection, lines 7 to 12 of Algorithm 1: finds bodies that touch, or may touch within the step.
#include <memory>
#include <vector>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/contact.hpp"
#include "rigid/bodies/world.hpp"
#include "rigid/collision/collision_backend.hpp"
#include "rigid/collision/separating_plane.hpp"
#include "rigid/collision/uniform_grid.hpp"
#include "rigid/math/types.hpp"
#include "rigid/shapes/shape_fwd.hpp"

namespace silt::rigid {

struct ShapeParts;

/// Numbers of contacts within the range of lubrication, with and without a film.
struct LubricationCounts {
  std::uint64_t with = 0, without = 0;
};

/// Detects contacts. Between calls it keeps only buffers and data of the shapes: the result depends on the
/// arguments alone and is the same on whichever rank finds a contact.
class DetectContacts {
 public:
  explicit DetectContacts(std::unique_ptr<BroadPhase> = std::make_unique<UniformGrid>());
  DetectContacts(DetectContacts&&) noexcept;
  ~DetectContacts();
  /// Fills contacts, sorted by key, with those of pairs that this rank handles: exchange.owns_contact_at is
  /// true for a point near both bodies at the least gap. Includes every point whose gap is at most the pair's
  /// margin: the distance by which the surfaces may approach in dt, at most world.contact_margin, and at
  /// least the range of lubrication where a film is possible (between a smooth surface and another one, a
  /// mesh or a tube). Returns the number of candidate pairs.
  std::size_t operator()(const World&, const BodySet&, const BodyExchange&, CollisionBackend&, double dt,
                         std::vector<Contact>& contacts);
  /// Returns counts of the last call. Each contact is counted by the rank that finds it.
  LubricationCounts lubrication() const { return lubrication_counts_; }

 private:
  struct Call {  // arguments of operator()
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
  struct Piece {  // a convex part of a body, or a mesh or tube
    const ShapeParts* of;
    std::size_t index;
    Pose pose;  // in the frame of the query
  };
  void prepare_shapes(const World&);
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
  void add_lubrication(const Pair&, const Piece& a, const Piece& b, const ContactPoint&, Contact&) const;
  static std::uint32_t code_of_a(const Piece& b, const ContactPoint&);
  ReducedRadii radii_of(const Pair&, const Piece& a, const Piece& b, const ContactPoint&) const;
  void set_separating_normals(const Pair&, const Piece& a, const Piece& b,
                              std::span<Contact> of_pieces) const;
  std::optional<SeparatingPlane> find_separating_plane(const Pair&, const Piece& a, const Piece& b,
                                                       const ContactPoint&, double reach) const;

  std::vector<ShapeParts> shapes_;
  bool with_meshes_ = false;
  std::unique_ptr<BroadPhase> broad_phase_;
  double least_margin_ = 0, pull_reach_ = 0;  // relative margin of resting contacts; range of attraction
  std::vector<Reach> reach_;
  std::vector<BoundingBox> boxes_;  // axis-aligned, relative to the bodies' positions; not set for spheres
  std::vector<double> turn_;        // displacement of a body's surface by rotation in the step
  std::vector<WallSurface> walls_;
  std::vector<CandidatePair> pairs_;
  std::vector<Piece> pieces_of_b_;  // of the current pair
  std::vector<ContactPoint> points_;
  LubricationCounts lubrication_counts_;
};

}  // namespace silt::rigid
