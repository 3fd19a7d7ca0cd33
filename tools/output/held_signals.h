/// What a signal that ends the program leaves behind: no unfinished file, and never some of several outputs.
#pragma once

#include <string>

namespace thimble::tools {

/// From here on every signal that ends the program first deletes the unfinished files below; those that whoever
/// started it ignores (nohup, a shell's background job) stay ignored. KILL and faults of the program do not.
void clean_up_on_signals();

/// While one of these lives, such a signal waits for its end. For steps that a signal must not come between.
class HeldSignals {
 public:
  HeldSignals();
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
};

/// `name` is a file to delete when a signal ends the program, until it is forgotten. It must stay where it is until
/// then. Both are called while signals are held.
void remember_unfinished(const std::string& name);
void forget_unfinished(const std::string& name);

}  // namespace thimble::tools
