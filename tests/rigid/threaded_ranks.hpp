#pragma once
// Ranks as threads of one program: a BodyExchange over shared memory, to test that rigid/ gives the same bits
// however bodies are spread. A rank owns a slab of x; it holds copies of what reaches into it, as far as
// contacts need.
#include <algorithm>
#include <barrier>
#include <map>
#include <thread>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::rigid::testing {

struct SharedMemory {
  explicit SharedMemory(int ranks)
      : ranks(ranks), barrier(ranks), sets(ranks), contacts(ranks), arrays(ranks), values(ranks) {}
  const int ranks;
  std::barrier<> barrier;
  std::vector<BodySet*> sets;
  std::vector<const std::vector<Contact>*> contacts;
  std::vector<double*> arrays;
  std::vector<double> values;
};

class ThreadedExchange : public BodyExchange {
 public:
  ThreadedExchange(const Extent& extent, const World& world, SharedMemory& memory, int rank)
      : BodyExchange(extent), world_(world), memory_(memory), rank_(rank) {}
  std::size_t visitors_seen = 0;

  void sum_forces(BodySet& bodies) override {
    publish(bodies);
    for (std::size_t row = 0; row < bodies.owned; ++row)
      for (int r = 0; r < memory_.ranks; ++r) {
        if (r == rank_) continue;
        BodySet& other = *memory_.sets[r];
        const std::size_t copy = other.row_of(bodies.id[row]);
        if (copy == other.size()) continue;
        bodies.force[row].add(other.force[copy]);
        bodies.torque[row].add(other.torque[copy]);
      }
    wait();
    for (std::size_t row = bodies.owned; row < bodies.size(); ++row)
      bodies.force[row] = bodies.torque[row] = {};
    wait();
  }

  void synchronise(BodySet& bodies) override {
    BodyExchange::synchronise(bodies);
    publish(bodies);
    std::map<BodyId, Body> all;
    for (const BodySet* set : memory_.sets)
      for (std::size_t row = 0; row < set->owned; ++row)
        all[set->id[row]] = {set->record(row), set->force[row], set->torque[row], set->stored_impulses[row]};
    wait();
    while (bodies.first_wall() > 0) bodies.erase(0);
    bodies.owned = bodies.copies = bodies.visitors = 0;
    for (auto& [id, body] : all)
      if (owner_of(body.record.position[0]) == rank_) add(bodies, body);
    for (auto& [id, body] : all) {
      const double reach = world_.bounding_radii[body.record.shape] + world_.contact_margin;
      if (owner_of(body.record.position[0]) == rank_ || distance_to_slab(body.record.position[0]) > reach)
        continue;
      bodies.insert(bodies.owned + bodies.copies++, body.record);
    }
    bodies.reindex();
    wait();
  }

  bool owns_contact_at(const Vec3& x) const override { return owner_of(x[0]) == rank_; }

  void exchange_contacts(BodySet& bodies, std::vector<Contact>& contacts) override {
    memory_.contacts[rank_] = &contacts;
    publish(bodies);
    std::vector<Contact> mine;
    const auto owned = [&](BodyId id) { return bodies.row_of(id) < bodies.owned; };
    for (const auto* list : memory_.contacts)
      for (const Contact& c : *list)
        if (owned(c.a) || owned(c.b)) mine.push_back(c);
    std::sort(mine.begin(), mine.end(), [](const auto& p, const auto& q) { return p.key() < q.key(); });
    std::map<BodyId, BodyRecord> missing;
    for (const Contact& c : mine)
      for (BodyId id : {c.a, c.b})
        if (bodies.row_of(id) == bodies.size()) missing[id] = owners_record(id);
    wait();
    for (auto& [id, record] : missing)
      bodies.insert(bodies.owned + bodies.copies + bodies.visitors++, record);
    visitors_seen += missing.size();
    bodies.reindex();
    contacts = mine;
    wait();
  }

  void share(BodySet& bodies, std::span<double> array, int width) override {
    memory_.arrays[rank_] = array.data();
    publish(bodies);
    for (std::size_t row = bodies.owned; row < bodies.first_wall(); ++row)
      for (int r = 0; r < memory_.ranks; ++r) {
        const std::size_t at = memory_.sets[r]->row_of(bodies.id[row]);
        if (at < memory_.sets[r]->owned)
          std::copy_n(memory_.arrays[r] + at * width, width, array.data() + row * width);
      }
    wait();
  }

  double maximum(double x) const override {
    memory_.values[rank_] = x;
    memory_.barrier.arrive_and_wait();
    const double largest = *std::max_element(memory_.values.begin(), memory_.values.end());
    memory_.barrier.arrive_and_wait();
    return largest;
  }

 private:
  struct Body {
    BodyRecord record;
    FixedVec3 force, torque;
    std::vector<StoredImpulse> impulses;
  };
  void wait() { memory_.barrier.arrive_and_wait(); }
  void publish(BodySet& bodies) {
    memory_.sets[rank_] = &bodies;
    wait();
  }
  int owner_of(double x) const {
    return std::clamp(static_cast<int>(x / extent_.size[0] * memory_.ranks), 0, memory_.ranks - 1);
  }
  double distance_to_slab(double x) const {
    const double width = extent_.size[0] / memory_.ranks, middle = (rank_ + 0.5) * width;
    double d = std::abs(x - middle);
    if (extent_.periodic[0]) d = std::min(d, extent_.size[0] - d);
    return d - 0.5 * width;
  }
  BodyRecord owners_record(BodyId id) const {
    for (const BodySet* set : memory_.sets) {
      const std::size_t row = set->row_of(id);
      if (row < set->owned) return set->record(row);
    }
    return {};
  }
  void add(BodySet& bodies, const Body& body) {
    const std::size_t row = bodies.owned;
    bodies.add(body.record);
    bodies.force[row] = body.force;
    bodies.torque[row] = body.torque;
    bodies.stored_impulses[row] = body.impulses;
  }

  const World& world_;
  SharedMemory& memory_;
  const int rank_;
};

}  // namespace silt::rigid::testing
