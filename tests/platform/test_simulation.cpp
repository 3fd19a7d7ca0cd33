// A simulated board: its memory ends where the board's does, its display forgives nothing, and what an
// application does wrong is said.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "boards/board_table.h"
#include "commands/key_script.h"
#include "host/guarded_bytes.h"
#include "host/simulation.h"
#include "host/strict_display.h"
#include "host/y4m.h"
#include "port.h"
#include "support/simulated_run.h"

namespace {

using namespace thimble;
using namespace thimble::host;
using tests::flagship;

using SimRan = tests::SimulatedRun;

// A simulation takes plain functions only.
SimRan run(int (*application)(), std::uint32_t frames = 1, ConstBytes scene = {},
           const tests::Hand& hand = {}, const platform::BoardFacts& board = flagship()) {
  return tests::run_simulated({&board, true, scene, application}, frames, hand);
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

constexpr std::int32_t kHeightPx = 64;
constexpr std::size_t kRowBytes = 64;  // 128 pixels of 4 bits

// Flushes `rows` rows from `first` on, each filled with its number.
void flush_rows(std::int32_t first, std::int32_t rows) {
  const Bytes bytes = port::arena().subspan(0, kRowBytes * static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < bytes.size; ++i) {
    bytes[i] = static_cast<std::uint8_t>(static_cast<std::size_t>(first) + i / kRowBytes);
  }
  port::flush({bytes, PixelFormat::kGray4, 0, first, rows});
}

void say(const std::string& text) {
  port::write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

int draws_bands_backwards() {
  for (std::uint32_t frame = 0; port::running(frame); ++frame) {
    for (std::int32_t row = kHeightPx - 8; row >= 0; row -= 8) {
      flush_rows(row, 8);
    }
  }
  return 0;
}

// A frame in bands of eight rows that are sent while others are drawn, in memory for `bands` of them.
template <int bands>
int sends_bands() {
  for (std::uint32_t frame = 0; port::running(frame); ++frame) {
    for (std::int32_t row = 0; row < kHeightPx; row += 8) {
      const std::size_t size = 8 * kRowBytes;
      const Bytes bytes = port::arena().subspan(size * static_cast<std::size_t>(row / 8 % bands), size);
      std::fill(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(row));
      port::begin_flush({bytes, PixelFormat::kGray4, 0, row, 8});
    }
    port::await_flush();
  }
  return port::band_buffers();
}

}  // namespace

TEST_CASE(
    "simulation: a board with two bands stops who writes into the one that is sent; with one it waits") {
  platform::BoardFacts board = flagship();
  CHECK(run(sends_bands<1>, 2).status == 1);
  board.band_buffers = 2;
  const SimRan turns = run(sends_bands<2>, 2, {}, {}, board);
  CHECK(turns.status == 2);
  CHECK(turns.fault.empty());
  CHECK(turns.pictures.size() == 2);
  REQUIRE(turns.last.bytes.size() == kRowBytes * kHeightPx);
  CHECK(turns.last.bytes.back() == kHeightPx - 8);
  const SimRan early = run(sends_bands<1>, 2, {}, {}, board);
  CHECK(early.status == port::kFaultStatus);
  CHECK(early.fault.find("written while it was being sent") != std::string::npos);
}

TEST_CASE("simulation: bands in any order -> the whole picture, asked once a frame, status 0") {
  const SimRan ran = run(draws_bands_backwards, 3);
  CHECK(ran.status == 0);
  CHECK(ran.fault.empty());
  CHECK(ran.pictures.size() == 3);
  REQUIRE(ran.last.bytes.size() == kRowBytes * kHeightPx);
  for (std::size_t i = 0; i < ran.last.bytes.size(); ++i) {
    REQUIRE(ran.last.bytes[i] == i / kRowBytes);
  }
}

TEST_CASE("simulation: facts and arena -> the board's RAM less its stack, to the byte, aligned to 8") {
  for (const platform::BoardFacts& board : platform::boards()) {
    static const platform::BoardFacts* expected;
    expected = &board;
    const SimRan ran = tests::run_simulated(
        {&board,
         false,
         {},
         [] {
           const port::Facts& facts = port::facts();
           const bool same =
               std::string(facts.name) == expected->name && facts.ram_bytes == expected->ram_bytes &&
               facts.flash_bytes == expected->flash_bytes && facts.stack_bytes == expected->stack_bytes &&
               facts.display.width_px == expected->width_px &&
               facts.display.height_px == expected->height_px && facts.display.format == expected->format &&
               !facts.display.connected;
           const Bytes arena = port::arena();
           const bool exact = arena.size == facts.ram_bytes - facts.stack_bytes &&
                              reinterpret_cast<std::uintptr_t>(arena.data) % 8 == 0;
           // All of it is there.
           std::fill(arena.begin(), arena.end(), std::uint8_t{1});
           return same && exact && port::scene().empty() && port::instructions() == 0 ? 5 : 6;
         }},
        1);
    CAPTURE(board.name);
    CHECK(ran.status == 5);
    CHECK(ran.use.ram_bytes == board.ram_bytes - board.stack_bytes);
  }
}

TEST_CASE("simulation: RAM used -> up to the last byte changed; flash used -> the scene") {
  const std::vector<std::uint8_t> scene(1001, 7);
  const SimRan ran = run(
      [] {
        port::arena()[999] = 1;
        const ConstBytes flash = port::scene();
        return std::accumulate(flash.begin(), flash.end(), 0) == 7 * 1001 ? 0 : 1;
      },
      1, {scene.data(), scene.size()});
  CHECK(ran.status == 0);
  CHECK(ran.use.ram_bytes == 1000);
  CHECK(ran.use.ram_limit_bytes == 61440);
  CHECK(ran.use.flash_bytes == 1001);
  CHECK(ran.use.flash_limit_bytes == 262144);
  CHECK(ran.use.stack_limit_bytes == 4096);
}

TEST_CASE("simulation: stack used -> at least the application's frames, and not much more") {
  const auto application = [] {
    std::array<volatile std::uint8_t, 3000> bytes;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      bytes[i] = static_cast<std::uint8_t>(i);
    }
    return port::stack_high_water() >= 3000 ? 0 : 1;
  };
  const SimRan ran = run(application);
  CHECK(ran.status == 0);
  CHECK(ran.use.stack_bytes >= 3000);
#ifndef __SANITIZE_ADDRESS__
  CHECK(ran.use.stack_bytes < 3600);
#endif
  // And the port itself takes little of it.
  const SimRan idle = run(draws_bands_backwards, 2);
#ifndef __SANITIZE_ADDRESS__
  CHECK(idle.use.stack_bytes < 1200);
#endif
  CHECK(idle.use.stack_bytes > 0);
}

TEST_CASE(
    "simulation: an application that goes wrong -> stopped with status 97 and a sentence that says how") {
  struct Case {
    const char* what;
    int (*application)();
    std::vector<std::string> says;
  };
  const std::vector<std::uint8_t> scene(104, 7);
  const std::vector<Case> cases{
      {"a byte past the RAM",
       [] {
         volatile std::uint8_t* const arena = port::arena().data;
         arena[61440] = 1;
         return 0;
       },
       {"wrote past its RAM", "byte 61440 of an arena of 61440 bytes"}},
      {"far past the RAM",
       [] {
         volatile std::uint8_t* const arena = port::arena().data;
         return static_cast<int>(arena[100000]);
       },
       {"read past its RAM", "byte 100000"}},
      {"a byte in front of the RAM, at the end",
       [] {
         volatile std::uint8_t* const arena = port::arena().data;
         arena[-1] = 1;
         return 0;
       },
       {"in front of its RAM"}},
      {"a page in front of the RAM",
       [] {
         volatile std::uint8_t* const arena = port::arena().data;
         arena[-8000] = 1;
         return 0;
       },
       {"wrote 8000 bytes in front of its RAM"}},
      {"a write to flash",
       [] {
         const_cast<volatile std::uint8_t*>(port::scene().data)[42] = 1;
         return 0;
       },
       {"wrote to flash", "byte 42"}},
      {"a read past the scene",
       [] {
         const volatile std::uint8_t* const flash = port::scene().data;
         return static_cast<int>(flash[104]);
       },
       {"read outside the scene", "byte 104 of 104"}},
      {"a stack without end",
       [] {
         struct Recursion {
           static int again(volatile int* depth) {
             std::array<volatile int, 64> frame;
             frame[static_cast<std::size_t>(*depth) % 64] = *depth;
             *depth = *depth + 1;
             return *depth < 1 << 30 ? again(depth) + frame[0] : 0;
           }
         };
         volatile int depth = 0;
         return Recursion::again(&depth);
       },
       {"stack overflowed"}},
      {"a wild pointer",
       [] {
         volatile std::uintptr_t address = 0x40;
         *reinterpret_cast<volatile std::uint8_t*>(address) = 1;
         return 0;
       },
       {"wrote at the address 0x40"}},
      {"an abort",
       [] {
         std::abort();
         return 0;
       },
       {"abort"}},
      {"a row beyond the display",
       [] {
         flush_rows(60, 8);
         return 0;
       },
       {"rows 60 to 67", "64 rows"}},
      {"a row twice",
       [] {
         flush_rows(0, 8);
         flush_rows(7, 1);
         return 0;
       },
       {"row 7 was flushed twice"}},
      {"half a frame",
       [] {
         flush_rows(0, 8);
         flush_rows(16, 48);
         port::running(1);
         return 0;
       },
       {"56 of 64 rows", "row 8"}},
      {"half a frame at the end",
       [] {
         flush_rows(8, 8);
         return 0;
       },
       {"8 of 64 rows", "row 0"}},
  };
  for (const Case& each : cases) {
    CAPTURE(each.what);
    const SimRan ran = run(each.application, 9, {scene.data(), scene.size()});
    CAPTURE(ran.fault);
    CHECK(ran.status == port::kFaultStatus);
    for (const std::string& words : each.says) {
      CAPTURE(words);
      CHECK(holds(ran.fault, words));
    }
  }
}

TEST_CASE("simulation: status, buttons and UART -> what the application returns, sees and says") {
  const auto echo = [] {
    static_cast<void>(port::running(0));  // until the bytes are there
    for (int byte = port::read(); byte >= 0; byte = port::read()) {
      say(std::string(1, static_cast<char>(byte)) + "!");
    }
    return static_cast<int>(port::buttons());
  };
  const SimRan ran = run(echo, 1, {}, {{{0, "abc"}}, {{0, port::kLeft | port::kSelect}}});
  CHECK(ran.out == "a!b!c!");
  CHECK(ran.status == (port::kLeft | port::kSelect));
  CHECK(ran.fault.empty());
}

TEST_CASE("simulation: more UART output than is kept between two looks -> none of it is lost") {
  const auto talk = [] {
    for (int line = 0; line < 30000; ++line) {
      say(std::to_string(line) + "\n");
    }
    return 0;
  };
  std::string expected;
  for (int line = 0; line < 30000; ++line) {
    expected += std::to_string(line) + "\n";
  }
  CHECK(run(talk).out == expected);
}

TEST_CASE("simulation: an application that is not answered any more -> left behind, and the next one runs") {
  {
    Simulation simulation({&flagship(), true, {}, draws_bands_backwards});
    while (simulation.wait(50) != Moment::kAsks) {
    }
  }
  CHECK(run(draws_bands_backwards, 2).pictures.size() == 2);
}

TEST_CASE("simulation: a scene larger than the flash -> an error that says by how much") {
  const std::vector<std::uint8_t> scene(262145);
  try {
    const Simulation simulation({&flagship(), true, {scene.data(), scene.size()}, draws_bands_backwards});
    FAIL("it was taken");
  } catch (const SimulationError& error) {
    CHECK(holds(error.what(), "1 more than the flash of lm3s6965evb"));
  }
}

TEST_CASE(
    "strict display: bands in another format, with gaps, empty or too short -> refused, nothing changed") {
  StrictDisplay display(10, 4, PixelFormat::kGray8);
  std::vector<std::uint8_t> pixels(40, 9);
  const Bytes all(pixels.data(), pixels.size());
  CHECK(display.flush({all, PixelFormat::kGray4, 0, 0, 1}));
  CHECK(display.flush({all, PixelFormat::kGray8, 10, 0, 1}));
  CHECK(display.flush({all, PixelFormat::kGray8, 0, 0, 0}));
  CHECK(display.flush({all, PixelFormat::kGray8, 0, 0, -1}));
  CHECK(display.flush({all, PixelFormat::kGray8, 0, -1, 2}));
  CHECK(display.flush({all, PixelFormat::kGray8, 0, 4, 1}));
  CHECK(display.flush({all, PixelFormat::kGray8, 0, INT32_MAX, INT32_MAX}));
  CHECK(display.flush({all.subspan(0, 19), PixelFormat::kGray8, 0, 0, 2}));
  CHECK_FALSE(display.end_frame());
  CHECK(display.pictures() == 0);
  CHECK_FALSE(display.flush({all, PixelFormat::kGray8, 0, 0, 4}));
  CHECK(display.pictures() == 1);
  CHECK_FALSE(display.flush({all.subspan(0, 30), PixelFormat::kGray8, 0, 1, 3}));
  CHECK(display.end_frame());
}

TEST_CASE(
    "strict display: rows that are kept -> as they were shown last; not before there is a whole picture") {
  StrictDisplay display(2, 3, PixelFormat::kGray8);
  const Band kept{{}, PixelFormat::kGray8, 0, 0, 1};
  CHECK(display.flush(kept));
  for (const std::uint8_t level : {std::uint8_t{1}, std::uint8_t{2}}) {
    std::vector<std::uint8_t> pixels(6, level);
    CHECK_FALSE(display.flush({{pixels.data(), 6}, PixelFormat::kGray8, 0, 0, 3}));
  }
  std::vector<std::uint8_t> pixels(4, 9);
  CHECK_FALSE(display.flush(kept));
  CHECK(display.end_frame());  // the others are missing still
  CHECK(display.flush(kept));  // twice
  CHECK_FALSE(display.flush({{pixels.data(), 4}, PixelFormat::kGray8, 0, 1, 2}));
  CHECK_FALSE(display.end_frame());
  CHECK(display.pictures() == 3);
  CHECK(display.picture().bytes == std::vector<std::uint8_t>{2, 2, 9, 9, 9, 9});
  CHECK(display.rows_sent() == 8);
  CHECK(display.rows_kept() == 1);
}

TEST_CASE("guarded bytes: any size -> exact bounds, offsets that name them, a front that is looked after") {
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{4095}, std::size_t{4096}, std::size_t{61440}}) {
    GuardedBytes guarded(size, 0xA5);
    const Bytes bytes = guarded.bytes();
    CHECK(bytes.size == size);
    CHECK(std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0xA5; }));
    CHECK(guarded.front_is_whole());
    const auto first = reinterpret_cast<std::uintptr_t>(bytes.data);
    CHECK(guarded.offset_of(first + size) == static_cast<std::ptrdiff_t>(size));
    CHECK(guarded.offset_of(first - 1) == -1);
    CHECK_FALSE(guarded.offset_of(first + (std::size_t{64} << 20)));
    if (size % 4096 != 0) {
      bytes.data[-1] = 0;
      CHECK_FALSE(guarded.front_is_whole());
    }
  }
}

TEST_CASE("packed picture: every format -> its darkest and lightest value are 0 and 255, the rest between") {
  const auto rgb = [](PixelFormat format, std::int32_t width, std::vector<std::uint8_t> bytes) {
    return tests::pixels_of({width, 1, format, std::move(bytes)});
  };
  CHECK(rgb(PixelFormat::kMono1, 9, {0x41, 0x80}) ==
        std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255, 0, 0,   0,   0,   0,   0,   0,  0,
                                  0, 0, 0, 0,   0,   0,   0, 255, 255, 255, 255, 255, 255});
  CHECK(rgb(PixelFormat::kGray4, 3, {0x0F, 0x80}) ==
        std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255, 136, 136, 136});
  CHECK(rgb(PixelFormat::kGray8, 2, {3, 250}) == std::vector<std::uint8_t>{3, 3, 3, 250, 250, 250});
  CHECK(rgb(PixelFormat::kRgb565, 2, {0x1F, 0xF8, 0xE0, 0x07}) ==
        std::vector<std::uint8_t>{255, 0, 255, 0, 255, 0});
}

TEST_CASE("key script: lines in any order -> steps by frame, buttons and bytes as written") {
  tools::KeyScript script("# a run\n\n 7: up left\n3: down left  select\r\n3:type a\\n\\x41\\\\ b\n");
  CHECK(script.take(2).empty());
  const auto third = script.take(3);
  REQUIRE(third.size() == 2);
  CHECK(third[0].press == (port::kLeft | port::kSelect));
  CHECK(third[0].release == 0);
  CHECK(third[1].typed == "a\nA\\ b");
  const auto rest = script.take(1000);
  REQUIRE(rest.size() == 1);
  CHECK(rest[0].release == port::kLeft);
  CHECK(script.take(UINT32_MAX).empty());
}

TEST_CASE("key script: lines that are none -> an error that names the line and the fault") {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"0: down left\nhello", "line 2: a line is"},
      {"x: down up", "line 1: a line is"},
      {"-1: down up", "line 1: a line is"},
      {"0: press up", "\"press\" is not down, up or type"},
      {"0: down", "a button is missing"},
      {"0: up sideways", "\"sideways\" is not up"},
      {"0: type \\q", "a backslash"},
      {"0: type \\x4", "two hexadecimal digits"},
      {"0: type \\xZZ", "two hexadecimal digits"},
      {"99999999999: up up", "line 1: frame 99999999999 is beyond 4294967295, the last"},
      {"0: type a\\", "a backslash"},
  };
  for (const auto& [each_text, words] : cases) {
    const auto& text = each_text;
    CAPTURE(text);
    try {
      const tools::KeyScript script(text);
      FAIL_CHECK("it was taken");
    } catch (const std::runtime_error& error) {
      CAPTURE(error.what());
      CHECK(holds(error.what(), words));
    }
  }
}

TEST_CASE("y4m: greys as they are, colours by Rec. 601, a header that says which") {
  CHECK(y4m_header(128, 64, true, 30) == "YUV4MPEG2 W128 H64 F30:1 Ip A1:1 Cmono\n");
  CHECK(y4m_header(2, 1, false, 7) == "YUV4MPEG2 W2 H1 F7:1 Ip A1:1 C444\n");
  CHECK(y4m_gray_frame({0, 128, 255}) == std::string("FRAME\n\0\x80\xFF", 9));
  const std::array<std::uint8_t, 12> rgb{0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 0, 255};
  // Black, white, red, blue: Y' 16 235 82 41, Cb 128 128 90 240, Cr 128 128 240 110.
  CHECK(y4m_color_frame({rgb.data(), 4, 1}) ==
        std::string("FRAME\n\x10\xEB\x52\x29\x80\x80\x5A\xF0\x80\x80\xF0\x6E", 18));
}
