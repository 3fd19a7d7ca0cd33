#include <doctest/doctest.h>

#include <cstdint>
#include <string_view>
#include <vector>

#include "scene/random.h"
#include "thimble/crc32.h"

namespace {

using thimble::ConstBytes;
using thimble::crc32;

std::uint32_t crc_of(std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return crc32(ConstBytes(bytes.data(), bytes.size()));
}

/// The definition, bit by bit: the remainder of the message, reflected, by the polynomial of IEEE 802.3.
std::uint32_t bitwise_crc(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t remainder = 0xFFFFFFFFU;
  for (const std::uint8_t byte : bytes) {
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = ((remainder ^ (static_cast<unsigned>(byte) >> bit)) & 1U) != 0;
      remainder >>= 1;
      if (carry) {
        remainder ^= 0xEDB88320U;
      }
    }
  }
  return remainder ^ 0xFFFFFFFFU;
}

}  // namespace

TEST_CASE("crc32: published check values -> met") {
  CHECK(crc_of("") == 0U);
  CHECK(crc_of("123456789") == 0xCBF43926U);
  CHECK(crc_of("a") == 0xE8B7BE43U);
  CHECK(crc_of("The quick brown fox jumps over the lazy dog") == 0x414FA339U);
  const std::uint8_t zeros[32] = {};
  CHECK(crc32(ConstBytes(zeros)) == 0x190A55ADU);
}

TEST_CASE("crc32: random buffers -> the bitwise definition, whole and cut anywhere") {
  constexpr std::uint64_t kSeed = 0xC0FFEE;
  thimble::tools::SplitMix64 random(kSeed);
  for (int turn = 0; turn < 300; ++turn) {
    CAPTURE(kSeed);
    CAPTURE(turn);
    std::vector<std::uint8_t> bytes(random.below(400));
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(random.next());
    }
    const ConstBytes all(bytes.data(), bytes.size());
    const std::uint32_t wanted = bitwise_crc(bytes);
    CHECK(crc32(all) == wanted);
    const std::size_t cut = random.below(bytes.size() + 1);
    CHECK(crc32(all.subspan(cut), crc32(all.subspan(0, cut))) == wanted);
    CHECK(crc32({}, wanted) == wanted);
  }
}
