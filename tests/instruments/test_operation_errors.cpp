// Every fixed-point operation against exact arithmetic: within the bound that its header names, and the bound
// means something.
#include <doctest/doctest.h>

#include <cstdint>
#include <set>
#include <string>

#include "instruments/operation_errors.h"
#include "support/counts.h"

namespace thimble::tools {
namespace {

const std::uint64_t kCases = thimble::tests::many_or_few<std::uint64_t>(100000, 3000);
constexpr std::uint64_t kSeed = 41;

TEST_CASE("operation errors: sweep -> none above its bound, and no bound above four times what is seen") {
  INFO("seed ", kSeed);
  double last = 0;
  std::set<std::string> names;
  for (const OperationError& found : sweep_operations(kCases, kSeed, [&](double done) {
         CHECK(done >= last);
         last = done;
       })) {
    INFO(found.operation, ": ", found.error, " of ", found.bound, " ", found.unit);
    CHECK(found.cases >= 256);
    CHECK(found.error <= found.bound);
    CHECK(found.bound <= 4 * found.error);
    CHECK(names.insert(found.operation).second);
  }
  CHECK(last == 1);
  CHECK(names.size() >= 24);
}

}  // namespace
}  // namespace thimble::tools
