// How many cases of a kind a test takes, and from which seed.
#pragma once

#include <cstdint>
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

/// What a variable of the environment says, or this.
inline std::int64_t number_from_environment(const char* name, std::int64_t otherwise) {
  const char* const text = std::getenv(name);
  return text != nullptr && *text != '\0' ? std::atoll(text) : otherwise;
}
/// The seed of all random cases: THIMBLE_SEED or this one.
inline std::uint64_t seed_or(std::uint64_t otherwise) {
  return static_cast<std::uint64_t>(
      number_from_environment("THIMBLE_SEED", static_cast<std::int64_t>(otherwise)));
}

}  // namespace thimble::tests
