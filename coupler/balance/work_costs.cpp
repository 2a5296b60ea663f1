#include "coupler/balance/work_costs.hpp"

#include "coupler/case/case.hpp"

namespace silt::coupler {

WorkCosts::WorkCosts(const Case& scene) {
  body = 1500 * scene.contacts.substeps;
  impulse = 1000 * scene.contacts.substeps;
  if (!scene.fluid) return;
  cell = scene.fluid->precision == Precision::single_ ? 10 : 20;  // by the bandwidth it takes
  link = scene.coupling.time == TimeCoupling::explicit_ ? 26 : 30;
  mapping = 90;
}

}  // namespace silt::coupler
