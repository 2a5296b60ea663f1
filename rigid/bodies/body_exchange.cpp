#include "rigid/bodies/body_exchange.hpp"

#include <cmath>

namespace silt::rigid {

void Extent::wrap(Vec3& x, std::array<std::int32_t, 3>& image) const {
  for (int d = 0; d < 3; ++d) {
    if (!periodic[d] || (x[d] >= 0 && x[d] < size[d])) continue;
    const double periods = std::floor(x[d] / size[d]);
    x[d] -= periods * size[d];
    const double now = image[d] + periods;  // may exceed 32 bits for a body that flies away
    image[d] = std::abs(now) <= 0x1p30 ? static_cast<std::int32_t>(now) : 1 << 30;
    if (x[d] < 0) x[d] = 0;  // rounding of the line above
    if (x[d] >= size[d]) {   // a tiny negative x was rounded up to the period
      x[d] = 0;
      ++image[d];
    }
  }
}

void BodyExchange::wrap_positions(BodySet& bodies) const {
  for (std::size_t row = 0; row < bodies.owned + bodies.copies; ++row)
    extent_.wrap(bodies.position[row], bodies.image[row]);
}

void BodyExchange::exchange_contacts(BodySet&, std::vector<Contact>&) {}

int BodyExchange::share_in_round(BodySet& bodies, std::span<double> rows, int width, int value,
                                 bool changed) {
  const EchoReduction::Message sent = cluster_.message(value);
  received_.resize(cluster_.partners().size());
  share(bodies, rows, width, {&sent, 1}, received_, changed);
  return cluster_.receive(value, received_);
}

}  // namespace silt::rigid
