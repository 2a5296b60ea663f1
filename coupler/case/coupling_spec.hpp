#pragma once
// How fluid and bodies are coupled: the table [coupling] of a case.
#include "lbm/force_form.hpp"
#include "lbm/wall_scheme.hpp"

namespace silt::coupler {

using lbm::WallScheme;
enum class TimeCoupling { explicit_, implicit_ };
enum class Refill { equilibrium, grad };
using lbm::ForceForm;

struct CouplingSpec {
  WallScheme wall_scheme = WallScheme::parabolic;
  TimeCoupling time = TimeCoupling::implicit_;
  Refill refill = Refill::grad;
  ForceForm force = ForceForm::galilean;
  bool mass_correction = true;
  double remap_tolerance = 0.02;   // cells a surface may move before its cells and wall distances are renewed
  bool lubrication = true;         // between close smooth surfaces; needs the resolver sffd
  double lubrication_min_gap = 0;  // where it stops growing; 0: Lubrication::relative_least_gap
};

}  // namespace silt::coupler
