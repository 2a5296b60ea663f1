#pragma once
// `--set key.path=value` and `--unset key.path`: changes to the tree of a case file before it is read; and
// what a case may change when its run goes on from a checkpoint: [run], [output] and [[quantities]], which do
// not act on the state.
#include <string>
#include <vector>

#include "coupler/case/case_error.hpp"

namespace silt::coupler {

/// Sets one value in the tree, making tables on the way; a key that says the same thing in another way
/// (run.steps and run.time) is removed. "key.path=", without a value, takes the key, table or entry of a list
/// away; it must be there. Throws CaseError.
void apply_override(adapters::Node& root, const std::string& argument);

/// Return what is wrong with an argument of --set or --unset at first sight, or "". An empty value is more
/// often a variable of the shell that is not set than a key to be taken away.
std::string complaint_of_set(const std::string& argument);
std::string complaint_of_unset(const std::string& argument);

/// Returns the option that gives an override: "--set fluid.density=960", "--unset run.balance".
std::string override_text(const std::string& argument);

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
