#pragma once
// Ranks as threads of one program: a BodyExchange over shared memory, to test that rigid/ gives the same bits
// however bodies are spread. A rank owns a slab of x; it holds copies of what reaches into it, as far as
// contacts need.
#include <algorithm>
#include <barrier>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <set>

#include "rigid/bodies/body_exchange.hpp"
#include "rigid/bodies/world.hpp"

namespace silt::rigid::testing {

/// A parcel is what one rank tells another in a share.
struct Parcel {
  std::vector<EchoReduction::Message> said;
  std::map<BodyId, std::vector<double>> rows;
};

/// Parcels on their way from one rank to another.
class Mail {
 public:
  void send(const Parcel& parcel) {
    const std::lock_guard lock(mutex_);
    parcels_.push_back(parcel);
    arrived_.notify_one();
  }
  Parcel take() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return !parcels_.empty(); });
    Parcel parcel = std::move(parcels_.front());
    parcels_.pop_front();
    return parcel;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Parcel> parcels_;
};

struct SharedMemory {
  explicit SharedMemory(int ranks)
      : ranks(ranks), barrier(ranks), sets(ranks), contacts(ranks), mail(ranks * ranks) {}
  const int ranks;
  std::barrier<> barrier;
  std::vector<BodySet*> sets;
  std::vector<const std::vector<Contact>*> contacts;
  std::vector<Mail> mail;  // from a rank to another
};

class ThreadedExchange : public BodyExchange {
 public:
  ThreadedExchange(const Extent& extent, const World& world, SharedMemory& memory, int rank)
      : BodyExchange(extent), world_(world), memory_(memory), rank_(rank) {}
  std::size_t visitors_seen = 0;

  void synchronise(BodySet& bodies) override {
    wrap_positions(bodies);
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
      const double drift = 0.5 * std::abs(body.record.velocity[0]);
      const double reach = world_.bounding_radii[body.record.shape] + world_.contact_margin + drift;
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
    find_partners(mine);
    wait();
    for (auto& [id, record] : missing)
      bodies.insert(bodies.owned + bodies.copies + bodies.visitors++, record);
    visitors_seen += missing.size();
    bodies.reindex();
    contacts = mine;
    wait();
  }

  /// Only the ranks that own a partner of a body owned here are waited for.
  void share(BodySet& bodies, std::span<double> array, int width,
             std::span<const EchoReduction::Message> said, std::span<EchoReduction::Message> heard,
             bool changed) override {
    Parcel mine{{said.begin(), said.end()}, {}};
    for (std::size_t row = 0; changed && row < bodies.owned; ++row)
      mine.rows[bodies.id[row]] = {array.begin() + row * width, array.begin() + (row + 1) * width};
    for (const int r : partners_) memory_.mail[rank_ * memory_.ranks + r].send(mine);
    for (std::size_t k = 0; const int r : partners_) {
      const Parcel theirs = memory_.mail[r * memory_.ranks + rank_].take();
      if (!heard.empty()) heard[k++] = theirs.said[0];
      for (std::size_t row = bodies.owned; row < bodies.first_wall(); ++row)
        if (const auto found = theirs.rows.find(bodies.id[row]); found != theirs.rows.end())
          std::copy(found->second.begin(), found->second.end(), array.data() + row * width);
    }
  }

 private:
  struct Body {
    BodyRecord record;
    FixedVec3 force, torque;
    std::vector<StoredImpulse> impulses;
  };
  void wait() { memory_.barrier.arrive_and_wait(); }
  void find_partners(const std::vector<Contact>& contacts) {
    partners_.clear();
    for (const Contact& c : contacts)
      for (const BodyId id : {c.a, c.b})
        for (int r = 0; r < memory_.ranks; ++r)
          if (!is_wall(id) && r != rank_ && memory_.sets[r]->row_of(id) < memory_.sets[r]->owned)
            partners_.insert(r);
    cluster_.begin(rank_, {partners_.begin(), partners_.end()}, memory_.ranks);
  }
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
  std::set<int> partners_;  // ranks that own a partner of a body owned here
};

}  // namespace silt::rigid::testing
