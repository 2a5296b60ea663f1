#include "rigid/response/contact_targets.hpp"

namespace silt::rigid {
namespace {

constexpr double no_gap = 1e-6;  // of the lever arms: a gap that is none

double pull(const Material& material, const Contact& c, bool pressed) {
  const double widest = (pressed || c.lubrication ? hair : no_gap) * lever_arms(c);
  double force = c.gap <= widest ? material.cohesion : 0;
  if (material.hamaker > 0 && c.gap <= material.van_der_waals_reach()) {
    const double gap = std::max(c.gap, material.hamaker_gap);
    force += material.hamaker * std::sqrt(c.radii.least * c.radii.largest) / (6 * gap * gap);
  }
  return force;
}

template <class Pressed>
void set(const Material& material, double dt, std::span<const Contact> contacts,
         std::span<ContactImpulse> impulses, Pressed pressed) {
  for (std::size_t k = 0; k < contacts.size(); ++k)
    impulses[k].pull =
        dt * pull(material, contacts[k], pressed(impulses[k])) / static_cast<double>(contacts.size());
}

}  // namespace

void set_pulls(const Material& material, double dt, std::span<const Contact> contacts,
               std::span<ContactImpulse> impulses) {
  set(material, dt, contacts, impulses, [](const ContactImpulse& i) { return i.normal > 0; });
}

void set_greatest_pulls(const Material& material, double dt, std::span<const Contact> contacts,
                        std::span<ContactImpulse> impulses) {
  set(material, dt, contacts, impulses, [](const ContactImpulse&) { return true; });
}

}  // namespace silt::rigid
