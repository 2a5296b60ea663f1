#include "coupler/placement/place_arrivals.hpp"

#include <algorithm>

#include "coupler/case/case.hpp"
#include "rigid/shapes/shape.hpp"

namespace silt::coupler {
namespace {

using rigid::Vec3;

/// A body that is there already, as other ranks see it.
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

/// Whether a box is so close to that of a fill that one of its bodies might ask for it.
bool concerns(const FillSpec& fill, const rigid::BoundingBox& box, double reach,
              const rigid::Extent& extent) {
  const Vec3 apart = nearest_image((box.lower + box.upper - fill.lower - fill.upper) / 2, extent).cwiseAbs();
  const Vec3 widths = (box.upper - box.lower + fill.upper - fill.lower) / 2;
  return ((apart - widths).array() <= reach).all();
}

/// The bodies near the fills' boxes that are within reach of this rank's blocks.
std::vector<GivenBody> present_near(const Case& scene, const std::vector<FillApplication>& applications,
                                    const rigid::BodySet& bodies, double reach, Surroundings& around) {
  for (std::size_t row = 0; row < bodies.owned; ++row) {
    const Present body = present(bodies, row);
    const auto box = rigid::bounding_box(scene.shapes[bodies.shape[row]], given(body).spec.pose);
    if (std::none_of(applications.begin(), applications.end(), [&](const FillApplication& application) {
          return concerns(scene.fills[application.fill], box, reach, around.extent);
        }))
      continue;
    parallel::put(around.messages.to(around.rank), body);
    for (const int rank : around.ranks_near(box))
      if (rank != around.rank) parallel::put(around.messages.to(rank), body);
  }
  around.messages.unannounced();
  std::vector<GivenBody> near;
  for (const parallel::Messages::Message& m : around.messages.received())
    for (parallel::ByteReader reader(m.bytes); !reader.done();) near.push_back(given(reader.take<Present>()));
  return near;
}

}  // namespace

std::vector<FillApplication> fills_due(const Case& scene, std::int64_t steps_done) {
  std::vector<FillApplication> due;
  for (std::size_t i = 0; i < scene.fills.size(); ++i)
    if (const FillSpec& fill = scene.fills[i]; fill.comes_at(steps_done))
      due.emplace_back(i, static_cast<std::uint64_t>(steps_done / fill.every));
  return due;
}

std::vector<AppliedFill> place_arrivals(const Case& scene, const std::vector<FillApplication>& applications,
                                        const lbm::Domain& domain, MPI_Comm comm,
                                        const rigid::BodySet& bodies, rigid::BodyId& next_id) {
  const double reach = reach_of_fills(scene);
  Surroundings around(scene, domain, comm, reach);
  const auto there = present_near(scene, applications, bodies, reach, around);
  return apply_fills(scene, applications, there, around, next_id);
}

}  // namespace silt::coupler
