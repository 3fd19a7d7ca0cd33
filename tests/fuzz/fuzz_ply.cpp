// libFuzzer target: read_ply on any bytes: refused with an InputError, or every promise of source.h kept.
//   clang++ -std=c++20 -g -O1 -fsanitize=fuzzer,address,undefined -Itools -Itests
//     tests/fuzz/fuzz_ply.cpp tools/readers/{ply,mesh,text}.cpp -o fuzz_ply
#include "fuzz/check_reader.h"
#include "readers/formats.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return thimble::tools::test::check_reader(thimble::tools::read_ply, {data, size});
}
