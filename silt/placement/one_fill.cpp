#include "silt/placement/place_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "coupler/spec/counter_random.hpp"
#include "rigid/math/elementary.hpp"
#include "rigid/shapes/shape.hpp"
#include "silt/case/case_check.hpp"
#include "silt/placement/rain.hpp"

namespace silt {
namespace {

using rigid::Vec3;

/// Returns a point uniform in a ball.
Vec3 moved_within(double radius, coupler::CounterRandom& random) {
  for (;;) {
    const Vec3 x = 2 * random.point() - Vec3::Ones();
    if (x.squaredNorm() <= 1) return radius * x;
  }
}

/// Returns the indices along an axis of sites that may lie in a block, each once.
std::vector<std::int64_t> sites_met(const Lattice& lattice, int axis, const lbm::CellBox& box, double shift) {
  constexpr double rows_and_layers = 2;  // sites: shift of rows and layers, and rounding
  const std::int64_t n = lattice.sites()[axis];
  const double step = lattice.step(axis), lower = box.lower[axis] - lattice.first(axis) - shift,
               upper = box.lower[axis] + box.size[axis] - lattice.first(axis) + shift;
  auto first = static_cast<std::int64_t>(std::floor(lower / step - rows_and_layers));
  auto last = static_cast<std::int64_t>(std::ceil(upper / step + 1));
  if (!lattice.goes_round(axis)) {
    first = std::max<std::int64_t>(first, 0);
    last = std::min(last, n - 1);
  } else if (last - first + 1 > n) {
    first = 0;
    last = n - 1;
  }
  std::vector<std::int64_t> met;
  for (std::int64_t i = first; i <= last; ++i) met.push_back((i % n + n) % n);
  return met;
}

/// Returns bodies on this rank's free sites, each moved by up to the fill's shift, by site number.
std::vector<FilledBody> on_free_sites(const OneFill& fill, const Lattice& lattice) {
  const FillSpec& spec = fill.spec;
  const Surroundings& around = fill.around;
  const std::uint64_t key = fill.application.key(spec);
  std::vector<FilledBody> bodies;
  const auto look_at = [&](int block, const Lattice::Index& i) {
    const Vec3 site = lattice.site(i);
    if (!lattice.in_room(site)) return;
    coupler::CounterRandom random(coupler::mixed(lattice.number(i) + key));
    FilledBody body{lattice.number(i), site + moved_within(spec.shift, random)};
    std::array<std::int32_t, 3> image{};
    around.extent.wrap(body.centre, image);
    if (around.holders.block_at(body.centre) != block) return;
    if (!fill.obstacles.is_free(body.centre, fill.radius, spec.gap)) return;
    if (!spec.aligned) body.orientation = random.orientation();
    bodies.push_back(body);
  };
  for (const auto& [block, box, rank] : around.domain.blocks_of(around.rank)) {
    std::array<std::vector<std::int64_t>, 3> met;
    for (int d = 0; d < 3; ++d) met[d] = sites_met(lattice, d, box, spec.shift);
    for (const std::int64_t z : met[2])
      for (const std::int64_t y : met[1])
        for (const std::int64_t x : met[0]) look_at(block, {x, y, z});
  }
  std::sort(bodies.begin(), bodies.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
  return bodies;
}

/// Adds bodies placed on this rank and near it to the obstacles.
void add_to_obstacles(const std::vector<FilledBody>& bodies, Surroundings& around, Obstacles& obstacles) {
  using Centre = std::array<double, 3>;
  for (const FilledBody& body : bodies) {
    const Vec3& x = body.centre;
    obstacles.add_ball(x);
    around.tell_others_near({x, x}, Centre{x[0], x[1], x[2]});
  }
  around.messages.exchange_sparse();
  around.messages.for_received<Centre>([&](const Centre& x, int) { obstacles.add_ball({x[0], x[1], x[2]}); });
}

using rigid::BoundingBox;

/// Rejected points per body after which the box counts as full: at the start, where missing bodies end the
/// run, and later, where they are left to the next application.
constexpr double points_a_body_at_start = 20000, points_a_body_later = 1000;
constexpr double bodies_a_cell = 4;

enum class PointState : std::uint8_t { open, stays, goes };

struct DrawnPoint {
  std::uint64_t number;
  Vec3 centre;
  bool own = true, shared = false, told = false;
  PointState state = PointState::open;
  bool waits = false;  // for another rank, in this round

  bool is_open() const { return own && state == PointState::open; }
  bool stays_here() const { return own && state == PointState::stays; }
};

/// A point in a message.
struct Seen {
  std::uint64_t number;
  double centre[3];
};
struct Decided {
  std::uint64_t number, stays;
};
struct Tally {
  std::uint64_t fallen, stay;
};

bool by_number(const auto& a, const auto& b) {
  return a.number < b.number;
}

class RandomFill {
 public:
  explicit RandomFill(const OneFill& fill)
      : fill_(fill),
        distance_(2 * fill.radius + fill.spec.gap),
        points_a_body_(fill.application.is_first() ? points_a_body_at_start : points_a_body_later),
        rain_(room_for_centres(fill.setup, fill.application.fill, fill.radius),
              fill.application.key(fill.spec),
              std::min(static_cast<double>(fill.count) / bodies_a_cell, Rain::most_cells / 2)) {}

  Filling placed() {
    std::uint64_t missing = fill_.count, round = 0, rounds = bodies_a_cell;
    for (;;) {
      let_fall(round, rounds);
      tell_neighbours();
      decide();
      const Tally all = tally();
      const bool enough = all.stay >= missing;
      keep(enough ? time_of_last(missing) : std::numeric_limits<std::uint64_t>::max());
      missing -= enough ? missing : all.stay;
      round += rounds;
      const bool full =
          static_cast<double>(all.fallen) >= points_a_body_ * static_cast<double>(all.stay + 1) ||
          round >= Rain::most_rounds;
      if (!enough && full && fill_.application.is_first()) refuse(fill_.count - missing);
      if (enough || full) break;
      rounds = std::min(next_rounds(rounds, all, missing), Rain::most_rounds - round);
    }
    std::sort(placed_.begin(), placed_.end(), by_number<FilledBody, FilledBody>);
    set_places(placed_, rain_.range(), around_);
    return {std::move(placed_), fill_.count - missing};
  }

 private:
  /// Returns the rounds needed according to the last ones; limited, as a full box needs too many.
  std::uint64_t next_rounds(std::uint64_t rounds, const Tally& last, std::uint64_t missing) const {
    const auto cells = static_cast<double>(rain_.total_cells());
    const double a_body = static_cast<double>(last.fallen + 1) / static_cast<double>(last.stay + 1);
    const double wanted = 1.1 * a_body * static_cast<double>(missing);
    const double most = std::max(2 * points_a_body_, 16 * static_cast<double>(fill_.count));
    const double next = std::ceil(std::min(wanted, most) / cells);
    return static_cast<std::uint64_t>(std::clamp(next, 1.0, 16.0 * static_cast<double>(rounds)));
  }

  void let_fall(std::uint64_t first_round, std::uint64_t rounds) {
    fallen_ = 0;
    points_.clear();
    for (const lbm::BlockPlace& block : around_.domain.blocks_of(around_.rank))
      let_fall_on(block, first_round, rounds);
  }

  /// Draws points of a block. A cell across blocks is drawn in each, a point kept in the block it lies in.
  void let_fall_on(const lbm::BlockPlace& block, std::uint64_t first_round, std::uint64_t rounds) {
    const auto along_x = cells_met(0, block.box), along_y = cells_met(1, block.box),
               along_z = cells_met(2, block.box);
    const auto take = [&](std::uint64_t number) {
      Vec3 centre = rain_.point(number);
      std::array<std::int32_t, 3> image{};
      around_.extent.wrap(centre, image);
      if (around_.holders.block_at(centre) != block.index) return;
      ++fallen_;
      if (fill_.obstacles.is_free(centre, fill_.radius, fill_.spec.gap)) points_.push_back({number, centre});
    };
    for (const std::int64_t z : along_z)
      for (const std::int64_t y : along_y)
        for (const std::int64_t x : along_x)
          for (std::uint64_t round = first_round; round < first_round + rounds; ++round)
            rain_.for_points({x, y, z}, round, take);
  }

  /// Returns the cells along an axis that overlap a block or its images; blocks at walls extend beyond.
  std::vector<std::int64_t> cells_met(int axis, const lbm::CellBox& box) const {
    constexpr double slack = 1e-6, infinity = std::numeric_limits<double>::infinity();
    const double length = around_.extent.size[axis];
    const bool periodic = around_.extent.periodic[axis];
    double lower = box.lower[axis] - slack, upper = box.lower[axis] + box.size[axis] + slack;
    if (!periodic && lower < 0) lower = -infinity;
    if (!periodic && upper > length) upper = infinity;
    const auto meets = [&](std::int64_t i, double shift) {
      return rain_.side(axis, i) + shift <= upper && rain_.side(axis, i + 1) + shift >= lower;
    };
    std::vector<std::int64_t> met;
    for (std::int64_t i = 0; i < rain_.cells()[axis]; ++i)
      if (meets(i, 0) || (periodic && (meets(i, -length) || meets(i, length)))) met.push_back(i);
    return met;
  }

  void tell_neighbours() {
    for (DrawnPoint& p : points_)
      p.shared = around_.tell_others_near({p.centre, p.centre},
                                          Seen{p.number, {p.centre[0], p.centre[1], p.centre[2]}});
    around_.messages.exchange_sparse();
    around_.messages.for_received<Seen>([&](const Seen& seen, int) {
      points_.push_back({seen.number, Vec3(seen.centre), false});
    });
    std::sort(points_.begin(), points_.end(), by_number<DrawnPoint, DrawnPoint>);
  }

  void decide() {
    NeighbourGrid grid(around_.extent, distance_);
    for (std::size_t i = 0; i < points_.size(); ++i)
      grid.insert(static_cast<int>(i), {points_[i].centre, points_[i].centre});
    do {
      decide_what_can_be(grid);
      hear_decisions();
    } while (around_.sum(std::ranges::count_if(points_, &DrawnPoint::is_open)) > 0);
  }

  /// Decides all points that wait for no other rank, and sends decisions on shared points.
  void decide_what_can_be(const NeighbourGrid& grid) {
    for (DrawnPoint& p : points_) p.waits = false;
    for (DrawnPoint& p : points_)
      if (p.is_open()) judge(p, grid);
    for (DrawnPoint& p : points_) {
      if (!p.shared || p.told || p.state == PointState::open) continue;
      p.told =
          around_.tell_others_near({p.centre, p.centre}, Decided{p.number, p.state == PointState::stays});
    }
  }

  /// Decides a point of this rank, after the earlier points close to it.
  PointState judge(DrawnPoint& p, const NeighbourGrid& grid) {
    const std::uint64_t time = rain_.time_of(p.number);
    PointState state = PointState::stays;
    grid.visit(BoundingBox::around(p.centre, Vec3::Constant(distance_)), [&](int i) {
      DrawnPoint& other = points_[i];
      if (other.state == PointState::goes || rain_.time_of(other.number) >= time) return true;
      if (coupler::nearest_image(other.centre - p.centre, around_.extent).norm() >= distance_) return true;
      const PointState found = other.is_open() && !other.waits ? judge(other, grid) : other.state;
      if (found == PointState::stays) state = PointState::goes;
      if (found == PointState::open) state = PointState::open;
      return state != PointState::goes;
    });
    p.waits = state == PointState::open;
    return p.state = state;
  }

  void hear_decisions() {
    around_.messages.exchange_sparse();
    around_.messages.for_received<Decided>([&](const Decided& decided, int) {
      std::lower_bound(points_.begin(), points_.end(), decided, by_number<DrawnPoint, Decided>)->state =
          decided.stays ? PointState::stays : PointState::goes;
    });
  }

  Tally tally() const {
    Tally mine{fallen_, 0};
    for (const DrawnPoint& p : points_) mine.stay += p.stays_here();
    return parallel::sum_over_ranks(around_.comm(), mine);
  }

  /// Returns, byte by byte, the time at which all ranks had accepted the wanted number of this batch.
  std::uint64_t time_of_last(std::uint64_t wanted) const {
    std::uint64_t time = 0, known = 0;  // known: mask of the bytes found
    for (int shift = 56; shift >= 0; shift -= 8) {
      std::array<std::uint64_t, 256> counts{};
      for (const DrawnPoint& p : points_)
        if (const std::uint64_t t = rain_.time_of(p.number); p.stays_here() && (t & known) == time)
          ++counts[t >> shift & 255];
      parallel::sum_over_ranks(around_.comm(), std::span(counts));
      std::uint64_t byte = 0;
      for (; counts[byte] < wanted; ++byte) wanted -= counts[byte];
      time |= byte << shift;
      known |= std::uint64_t{255} << shift;
    }
    return time;
  }

  void keep(std::uint64_t last_time) {
    for (const DrawnPoint& p : points_) {
      if (p.state != PointState::stays || rain_.time_of(p.number) > last_time) continue;
      fill_.obstacles.add_ball(p.centre);
      if (!p.own) continue;
      placed_.push_back({p.number, p.centre});
      if (!fill_.spec.aligned) placed_.back().orientation = rain_.orientation(p.number);
    }
  }

  [[noreturn]] void refuse(std::uint64_t placed) const {
    const FillSpec& spec = fill_.spec;
    double balls = 0;  // volume, over all sizes
    for (std::size_t size = 0; size < spec.sizes.size(); ++size) {
      const double radius = rigid::bounding_radius(fill_.setup.shapes[spec.sizes[size].shape]) + spec.gap / 2;
      balls += static_cast<double>(FillApplication(fill_.application.fill, 0, size).count(spec)) * 4. / 3 *
               std::numbers::pi * rigid::elementary::power(radius, 3);
    }
    const std::string those = spec.sizes.size() == 1
                                  ? ""
                                  : fmt::format("of the {} of diameter {} ", fill_.count,
                                                shown_length(fill_.setup, 2 * fill_.radius));
    const CurvedWalls walls(fill_.setup);
    const double left = walls.share_left(spec.box, 0);
    const double room = left * (spec.box.upper - spec.box.lower).prod();
    throw CaseError(
        fill_.setup.place(fmt::format("fill[{}].count", fill_.application.fill)),
        fmt::format(
            "fill[{}].count is {}, but {}only {} bodies fitted: with their gaps the bounding spheres "
            "would take {:.0f} % of the box{}, and random places run out near 35 % of what other "
            "bodies leave; lower count or gap, enlarge box or domain, or make the bodies smaller",
            fill_.application.fill, spec.count, those, placed, 100 * balls / room,
            walls.empty() ? "" : fmt::format(" less its walls, which leave {:.0f} % of it", 100 * left)));
  }

  const OneFill& fill_;
  const double distance_;  // least distance of centres
  const double points_a_body_;
  Surroundings& around_ = fill_.around;
  const Rain rain_;
  std::uint64_t fallen_ = 0;  // points of this batch on this rank
  // points of this batch free of earlier bodies; by number, so that neighbours are close in memory
  std::vector<DrawnPoint> points_;
  std::vector<FilledBody> placed_;
};

}  // namespace

/// Takes the first free sites, as many as asked for or all.
Filling fill_sites(const OneFill& fill) {
  const auto count = static_cast<std::uint64_t>(fill.count);
  const std::size_t index = fill.application.fill;
  const Lattice lattice = lattice_of(fill.setup, fill.application, fill.radius);
  std::vector<FilledBody> bodies = on_free_sites(fill, lattice);
  set_places(bodies, std::max<std::uint64_t>(1, lattice.total()), fill.around);
  const std::uint64_t sites = fill.around.sum(bodies.size());
  if (fill.application.is_first() && sites < std::max<std::uint64_t>(count, 1))
    throw CaseError(fill.setup.place(fmt::format("fill[{}].count", index)),
                    fmt::format("fill[{}].count is {}, but there are only {} free sites; lower count, gap or "
                                "spacing, or enlarge box or domain",
                                index, count, sites));
  const std::uint64_t total = count > 0 ? std::min(count, sites) : sites;
  std::erase_if(bodies, [&](const FilledBody& body) { return body.place >= total; });
  add_to_obstacles(bodies, fill.around, fill.obstacles);
  return {std::move(bodies), total};
}

Filling fill_at_random(const OneFill& fill) {
  return RandomFill(fill).placed();
}

}  // namespace silt
