// libFuzzer target: read_obj on any bytes: refused with an InputError, or every promise of source.h kept.
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -Itools -Itests -DTINYOBJLOADER_USE_DOUBLE
//     tests/fuzz/fuzz_obj.cpp tools/readers/{obj,mesh,text}.cpp -ltinyobjloader_double -o fuzz_obj
#include "fuzz/check_reader.h"
#include "readers/formats.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return thimble::tools::test::check_reader(thimble::tools::read_obj, {data, size});
}
