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
  /// The distance in cells that a surface may move before it is mapped again (mapping/mapping_poses.hpp). At
  /// most 0.4: ranks may not know of a body more than 1/2 from where it was mapped (exchange/holders.hpp).
  double remap_tolerance = 0.1;
  bool lubrication = true;         // between close smooth surfaces; needs the resolver sffd
  double lubrication_min_gap = 0;  // cells, below which it is constant; 0: Lubrication::relative_least_gap
};

}  // namespace silt::coupler
