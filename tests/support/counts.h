// How many cases of a kind a test takes.
#ifndef THIMBLE_TESTS_SUPPORT_COUNTS_H
#define THIMBLE_TESTS_SUPPORT_COUNTS_H

#include <cstdlib>
#include <cstring>

namespace thimble::tests {

/// Few: sanitized builds and those that are not optimised, which take as long for a tenth, and where THIMBLE_FEW is `all`, as
/// `make test` says. `make test-all` takes many.
inline bool takes_few() {
#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
  return true;
#else
  const char* const few = std::getenv("THIMBLE_FEW");
  return few != nullptr && std::strcmp(few, "all") == 0;
#endif
}
template <class Count>
Count many_or_few(Count many, Count few) {
  return takes_few() ? few : many;
}

}  // namespace thimble::tests

#endif
