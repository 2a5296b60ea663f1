#pragma once
// What a case may change when its run goes on from a checkpoint: [run], [output] and [[quantities]], which do
// not act on the state.
#include <string>
#include <vector>

namespace silt::coupler {

struct Case;
struct CaseSource;

/// What a checkpoint remembers of the case it was written for: the members of Case of the same names.
struct CaseOrigin {
  std::string text;
  std::vector<std::string> overrides, files;
};

/// Reads the case that a run goes on with: what the source holds now, with the --set of the run that wrote
/// the checkpoint and then those given. CaseError, saying where, if anything else differs from what the run
/// began with.
Case case_to_resume(const CaseOrigin&, CaseSource&, const std::vector<std::string>& overrides);

/// Returns the options of the run that wrote the checkpoint which still hold: "--set run.steps=60 --unset
/// run.balance"; "" if there are none.
std::string earlier_options(const CaseOrigin&, const std::vector<std::string>& overrides);

}  // namespace silt::coupler
