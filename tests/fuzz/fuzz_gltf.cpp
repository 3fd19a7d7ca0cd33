// libFuzzer target: read_gltf on any bytes: refused with an InputError, or every promise of source.h kept.
#include "fuzz/check_reader.h"
#include "readers/gltf.h"

namespace {
thimble::tools::Source read_alone(const thimble::tools::SharedBytes& file,
                                  const thimble::tools::Progress& progress) {
  return thimble::tools::read_gltf(file, "", progress);
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return thimble::tools::test::check_reader(read_alone, {data, size});
}
