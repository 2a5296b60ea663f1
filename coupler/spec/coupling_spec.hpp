#pragma once
// The parameters of the coupling of fluid and bodies.
#include "coupler/spec/name_table.hpp"
#include "lbm/walls/wall_scheme.hpp"

namespace silt::coupler {

using lbm::WallScheme;
inline constexpr NameTable<WallScheme, lbm::wall_scheme_names.size()> wall_scheme_names{
    lbm::wall_scheme_names};

enum class TimeCoupling { explicit_, implicit_ };
inline constexpr auto time_coupling_names = names_of<TimeCoupling>("explicit", "implicit");

using lbm::ForceForm;
inline constexpr NameTable<ForceForm, lbm::force_form_names.size()> force_form_names{lbm::force_form_names};

struct CouplingSpec {
  WallScheme wall_scheme = WallScheme::multireflection;
  TimeCoupling time = TimeCoupling::implicit_;
  ForceForm force = ForceForm::galilean;
  /// A surface may be this far, in cells, from where its cells were found; mapping/mapping_poses.hpp. At most
  /// 0.4: holders of a body that is more than 1/2 from there might not know of it (exchange/holders.hpp).
  double remap_tolerance = 0.1;
  bool lubrication = true;         // between close smooth surfaces; needs the resolver sffd
  double lubrication_min_gap = 0;  // where it stops growing; 0: Lubrication::relative_least_gap
};

}  // namespace silt::coupler
