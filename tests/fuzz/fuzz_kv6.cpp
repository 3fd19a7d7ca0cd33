// libFuzzer target: read_kv6 on any bytes: refused with an InputError, or every promise of source.h kept.
#include "fuzz/check_reader.h"
#include "readers/formats.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return thimble::tools::test::check_reader(thimble::tools::read_kv6, {data, size});
}
