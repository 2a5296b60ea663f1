#pragma once
// The sizes of a [[fill]] whose bodies differ: a distribution of diameters as a list of a few, which every
// rank knows. A diameter is that of the sphere of a body's volume.
#include <vector>

#include "coupler/case/case_reader.hpp"

namespace silt::coupler {

struct Case;
struct FillSpec;

/// One of the sizes: so large a share of the bodies, by number, has this diameter (cells).
struct SizeShare {
  double diameter, share;
};

KeySection fill_size_section();

/// Reads the table `diameter` of a fill: none without it, or where it is wrong (reported). A continuous
/// distribution is cut into strips between diameters of equal ratios; all bodies of one have the diameter of
/// their mean volume.
std::vector<SizeShare> read_fill_sizes(TableReader& fill);

/// Gives the fills the shapes of their sizes, which are added to those of the case. sizes: one list a fill.
/// The largest takes the place of the shape that was given, where no other body has that.
void set_fill_sizes(Case&, const std::vector<std::vector<SizeShare>>& sizes);

/// The mean of the volumes of a fill's bodies.
double mean_volume(const Case&, const FillSpec&);

}  // namespace silt::coupler
