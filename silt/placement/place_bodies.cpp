#include "silt/placement/place_bodies.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "parallel/communicator.hpp"
#include "silt/case/case.hpp"

namespace silt {

std::vector<std::uint64_t> number_off(parallel::Messages& messages, const std::vector<std::uint64_t>& keys,
                                      std::uint64_t range) {
  const int ranks = parallel::ranks_of(messages.comm());
  const auto rank_of = [&](std::uint64_t key) {
    return static_cast<int>(static_cast<unsigned __int128>(key) * ranks / range);
  };
  for (const std::uint64_t key : keys) parallel::put(messages.to(rank_of(key)), key);
  messages.exchange_sparse();
  std::vector<std::pair<std::uint64_t, int>> asked;  // keys of this slice from all ranks, and their ranks
  messages.for_received<std::uint64_t>([&](std::uint64_t key, int rank) { asked.emplace_back(key, rank); });
  std::sort(asked.begin(), asked.end());
  std::uint64_t before = parallel::sum_of_ranks_before(messages.comm(), asked.size());
  for (const auto& [key, rank] : asked) parallel::put(messages.to(rank), before++);
  messages.exchange_sparse();
  std::vector<std::uint64_t> numbers;  // slices answer in the order of ranks, which is that of keys
  messages.for_received<std::uint64_t>([&](std::uint64_t number, int) { numbers.push_back(number); });
  return numbers;
}

void set_places(std::vector<FilledBody>& bodies, std::uint64_t range, Surroundings& around) {
  std::vector<std::uint64_t> numbers;
  for (const FilledBody& body : bodies) numbers.push_back(body.number);
  const std::vector<std::uint64_t> places = number_off(around.messages, numbers, range);
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].place = places[i];
}

namespace {

using rigid::Vec3;

int shape_of(const Case& setup, const FillApplication& application) {
  return setup.fills[application.fill].sizes[application.size].shape;
}

double radius_of(const Case& setup, const FillApplication& application) {
  return rigid::bounding_radius(setup.shapes[shape_of(setup, application)]);
}

/// Returns the order of applications by size, largest first, as small bodies still fit between large ones.
std::vector<std::size_t> by_size(const Case& setup, const std::vector<FillApplication>& applications) {
  std::vector<std::size_t> order(applications.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return radius_of(setup, applications[a]) > radius_of(setup, applications[b]);
  });
  return order;
}

AppliedFill apply(const Case& setup, FillApplication application, Surroundings& around,
                  Obstacles& obstacles) {
  const FillSpec& spec = setup.fills[application.fill];
  const OneFill fill{setup,  application, spec, application.count(spec), radius_of(setup, application),
                     around, obstacles};
  AppliedFill filled;
  static_cast<EntrySpec&>(filled.alike) = spec;
  filled.alike.shape = shape_of(setup, application);
  if (fill.count == 0 && spec.count > 0) return filled;  // no body has this size
  obstacles.begin_balls(fill.radius, spec.gap);
  Filling placed = spec.arrangement == Arrangement::random ? fill_at_random(fill) : fill_sites(fill);
  const auto count = static_cast<std::uint64_t>(fill.count);
  filled.bodies = std::move(placed.bodies), filled.total = placed.total;
  filled.refused = count - std::min(count, filled.total);
  return filled;
}

/// Returns the largest distance at which a fill looks for existing bodies.
double reach_of_fills(const Case& setup) {
  double radius = 0, gap = 0;
  for (std::size_t i = 0; i < setup.fills.size(); ++i) {
    radius = std::max(radius, rigid::bounding_radius(setup.shapes[setup.fills[i].shape]));
    gap = std::max(gap, setup.fills[i].gap);
  }
  return 2 * radius + gap;
}

/// Applies fills: each bounding sphere touches neither existing bodies, known within reach_of_fills of this
/// rank's blocks, nor another one. Ids continue from `next_id` in the order of the applications, and
/// `next_id` is advanced.
std::vector<AppliedFill> apply_fills(const Case& setup, const std::vector<FillApplication>& applications,
                                     std::span<const GivenBody> there, Surroundings& around,
                                     rigid::BodyId& next_id) {
  std::vector<AppliedFill> applied(applications.size());
  if (applications.empty()) return applied;
  Obstacles obstacles(setup, around.extent, there, reach_of_fills(setup));
  for (const std::size_t i : by_size(setup, applications))
    applied[i] = apply(setup, applications[i], around, obstacles);
  for (AppliedFill& filled : applied) {
    filled.first_id = next_id;
    next_id += filled.total;
  }
  return applied;
}

/// An existing body in a message.
struct Present {
  rigid::BodyId id;
  std::int64_t shape;
  double position[3], orientation[4];  // w, x, y, z
};

Present present(const rigid::BodySet& bodies, std::size_t row) {
  const rigid::Quat& q = bodies.orientation[row];
  const Vec3& x = bodies.position[row];
  return {bodies.id[row], bodies.shape[row], {x[0], x[1], x[2]}, {q.w(), q.x(), q.y(), q.z()}};
}

GivenBody given(const Present& p) {
  BodySpec spec;
  spec.shape = static_cast<int>(p.shape);
  spec.pose.position = Eigen::Map<const Vec3>{p.position};
  spec.pose.orientation = {p.orientation[0], p.orientation[1], p.orientation[2], p.orientation[3]};
  return {p.id, spec, false};
}

/// Returns whether a box is so close to that of a fill that it may matter to its bodies.
bool concerns(const FillSpec& fill, const rigid::BoundingBox& box, double reach,
              const rigid::Extent& extent) {
  const Vec3 apart =
      coupler::nearest_image((box.lower + box.upper - fill.box.lower - fill.box.upper) / 2, extent)
          .cwiseAbs();
  const Vec3 widths = (box.upper - box.lower + fill.box.upper - fill.box.lower) / 2;
  return ((apart - widths).array() <= reach).all();
}

/// Returns the existing bodies near the fills' boxes and within reach of this rank's blocks.
std::vector<GivenBody> present_near(const Case& setup, const std::vector<FillApplication>& applications,
                                    const rigid::BodySet& bodies, double reach, Surroundings& around) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const Present body = present(bodies, row);
    const auto box = rigid::bounding_box(setup.shapes[bodies.shape[row]], given(body).spec.pose);
    if (std::ranges::none_of(applications, [&](const FillApplication& application) {
          return concerns(setup.fills[application.fill], box, reach, around.extent);
        }))
      continue;
    parallel::put(around.messages.to(around.rank), body);
    around.tell_others_near(box, body);
  }
  around.messages.exchange_sparse();
  std::vector<GivenBody> near;
  around.messages.for_received<Present>([&](const Present& body, int) { near.push_back(given(body)); });
  return near;
}

void store(const Vec3& v, double* to) {
  Eigen::Map<Vec3>{to} = v;
}

}  // namespace

std::size_t PlacedBodies::size() const {
  std::size_t n = given.size();
  for (const AppliedFill& fill : filled) n += fill.bodies.size();
  return n;
}

PlacedBodies place_bodies(const Case& setup, const lbm::Domain& domain, MPI_Comm comm,
                          const rigid::BodySet* there) {
  Surroundings around(setup, domain, comm, reach_of_fills(setup));
  PlacedBodies placed;
  placed.given = given_bodies(setup, around);
  placed.next_id = 1 + count_given(setup);
  std::vector<FillApplication> all;
  for (std::size_t i = 0; i < setup.fills.size(); ++i)
    for (std::size_t size = 0; size < setup.fills[i].sizes.size(); ++size) all.emplace_back(i, 0, size);
  if (there && !all.empty()) {
    const auto near = present_near(setup, all, *there, reach_of_fills(setup), around);
    placed.given.insert(placed.given.end(), near.begin(), near.end());
  }
  placed.filled = apply_fills(setup, all, placed.given, around, placed.next_id);
  std::erase_if(placed.given, [](const GivenBody& body) { return !body.own; });
  return placed;
}

std::vector<FillApplication> fills_due(const Case& setup, std::int64_t steps_done) {
  std::vector<FillApplication> due;
  for (std::size_t i = 0; i < setup.fills.size(); ++i)
    if (const FillSpec& fill = setup.fills[i]; fill.applies_after(steps_done))
      for (std::size_t size = 0; size < fill.sizes.size(); ++size)
        due.emplace_back(i, static_cast<std::uint64_t>(steps_done / fill.every), size);
  return due;
}

std::vector<AppliedFill> place_arrivals(const Case& setup, const std::vector<FillApplication>& applications,
                                        const lbm::Domain& domain, MPI_Comm comm,
                                        const rigid::BodySet& bodies, rigid::BodyId& next_id) {
  const double reach = reach_of_fills(setup);
  Surroundings around(setup, domain, comm, reach);
  const auto there = present_near(setup, applications, bodies, reach, around);
  return apply_fills(setup, applications, there, around, next_id);
}

std::vector<CentredShape> centred_shapes(const Case& setup) {
  std::vector<CentredShape> shapes;
  for (const rigid::Shape& shape : setup.shapes) {
    const rigid::MassProperties mass = rigid::mass_properties(shape);
    shapes.push_back({shape, mass.volume, rigid::bounding_radius(shape), mass.inertia});
  }
  return shapes;
}

rigid::BodyRecord body_record(rigid::BodyId id, const BodySpec& body, const CentredShape& shape,
                              bool in_fluid) {
  rigid::BodyRecord r;
  r.id = id;
  r.shape = body.shape, r.material = body.material, r.kind = body.kind;
  r.motion = body.motion;
  r.mass = body.density * shape.volume;
  r.weight_in_fluid = in_fluid ? 1 - 1 / body.density : 1;
  Eigen::Map<rigid::Mat3>{r.inertia_B} = body.density * shape.inertia;
  rigid::Quat q = body.pose.orientation;
  if (!body.unit) q.normalize();
  store(body.pose.position, r.position);
  r.orientation[0] = q.w(), r.orientation[1] = q.x(), r.orientation[2] = q.y(), r.orientation[3] = q.z();
  store(body.velocity, r.velocity);
  store(body.angular_velocity, r.angular_velocity);
  return r;
}

using rigid::BodyId;

/// Returns the starts of the bodies that this rank keeps, by id.
std::vector<StartPositions::Start> StartPositions::met_here(const Case& setup, const lbm::Domain& domain,
                                                            MPI_Comm comm) {
  const int ranks = parallel::ranks_of(comm);
  parallel::Messages messages(comm);
  place_bodies(setup, domain, comm).for_each([&](BodyId id, const BodySpec& body) {
    const Vec3& x = body.pose.position;
    parallel::put(messages.to(static_cast<int>(id % ranks)), Start{id, {x[0], x[1], x[2]}});
  });
  messages.exchange_sparse();
  std::vector<Start> starts;
  messages.for_received<Start>([&](const Start& start, int) { starts.push_back(start); });
  std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.id < b.id; });
  return starts;
}

StartPositions::Start StartPositions::found(const std::vector<Start>& starts, BodyId id) {
  constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();
  const auto at = std::lower_bound(starts.begin(), starts.end(), id,
                                   [](const Start& s, BodyId wanted) { return s.id < wanted; });
  return at != starts.end() && at->id == id ? *at : Start{id, {nowhere, nowhere, nowhere}};
}

std::vector<Vec3> StartPositions::of(const Case& setup, const lbm::Domain& domain, MPI_Comm comm,
                                     std::span<const BodyId> ids) const {
  if (!starts_) starts_ = met_here(setup, domain, comm);
  const int ranks = parallel::ranks_of(comm);
  parallel::Messages messages(comm);
  for (const BodyId id : ids) parallel::put(messages.to(static_cast<int>(id % ranks)), id);
  messages.exchange_sparse();
  std::vector<std::pair<int, BodyId>> asked;
  messages.for_received<BodyId>([&](BodyId id, int rank) { asked.emplace_back(rank, id); });
  for (const auto& [rank, id] : asked) parallel::put(messages.to(rank), found(*starts_, id));
  messages.exchange_sparse();
  std::vector<Start> answers;
  messages.for_received<Start>([&](const Start& start, int) { answers.push_back(start); });
  std::sort(answers.begin(), answers.end(), [](const Start& a, const Start& b) { return a.id < b.id; });
  std::vector<Vec3> positions;
  for (const BodyId id : ids) positions.push_back(Eigen::Map<const Vec3>{found(answers, id).position});
  return positions;
}

}  // namespace silt
