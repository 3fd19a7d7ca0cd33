// The pixel formats of panels, which an image has on demand (THIMBLE_PANEL_FORMATS): bytes worked out by hand,
// the dithers, and a golden frame in each.
#include "golden/panel_table.h"
#include "portable/golden_trees.h"
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/base/memory.h"

namespace thimble::portable {
namespace {

constexpr PixelFormat kFormats[] = {PixelFormat::kRgb565Be,   PixelFormat::kBgr565,   PixelFormat::kRgb444,
                                    PixelFormat::kMono1Pages, PixelFormat::kGray4Low, PixelFormat::kGray2,
                                    PixelFormat::kPaper3,     PixelFormat::kPaper7,   PixelFormat::kRgb332};
constexpr int kFormatCount = sizeof kFormats / sizeof kFormats[0];

constexpr Rgb8 kBlack{0, 0, 0};
constexpr Rgb8 kWhite{255, 255, 255};
constexpr Rgb8 kGreen{0, 255, 0};
constexpr Rgb8 kBlue{0, 0, 255};
constexpr Rgb8 kRed{255, 0, 0};
constexpr Rgb8 kYellow{255, 255, 0};
constexpr Rgb8 kOrange{255, 128, 0};
constexpr Rgb8 kSeven[] = {kBlack, kWhite, kGreen, kBlue, kRed, kYellow, kOrange};

constexpr Rgb8 gray(int value) {
  const uint8_t channel = static_cast<uint8_t>(value);
  return {channel, channel, channel};
}

void expect_row(Check& check, PixelFormat format, Span<const Rgb8> colors, int32_t y, ConstBytes wanted,
                What what) {
  uint8_t row[24] = {};
  for (size_t x = 0; x < colors.size; ++x) {
    store_pixel(row, static_cast<int32_t>(x), y, format, colors[x]);
  }
  check.equal(ConstBytes(row, row_bytes(format, static_cast<int32_t>(colors.size))), wanted, what);
}

// Rows of every width up to 19, white, between guards: what is loaded is white, and nothing lies beyond.
void white_rows(Check& check, int index) {
  const PixelFormat format = kFormats[index];
  for (int32_t width = 1; width < 20; ++width) {
    uint8_t row[60] = {};
    uint8_t before[60] = {};
    const size_t bytes = row_bytes(format, width);
    row[0] = row[bytes + 1] = 0xA5;
    for (int32_t x = 0; x < width; ++x) {
      store_pixel(row + 1, x, 5, format, kWhite);
    }
    THIMBLE_EQUAL(row[0], 0xA5);
    THIMBLE_EQUAL(row[bytes + 1], 0xA5);
    for (int32_t x = 0; x < width; ++x) {
      THIMBLE_EQUAL(load_pixel(row + 1, x, 5, format), kWhite);
    }
    check.note_bytes({row + 1, bytes});
    // Cleared pixel by pixel nothing is left, so no bit was anybody else's.
    for (int32_t x = 0; x < width; ++x) {
      clear_panel_pixel(row + 1, x, 5, format);
      store_pixel(row + 1, x, 5, format, kBlack);
    }
    THIMBLE_EQUAL(ConstBytes(row + 1, bytes), ConstBytes(before, bytes));
  }
}

// What each place of a cell makes of a colour, added up: for dithers that mix, 64 times the colour.
void mean_of_cell(Check& check, PixelFormat format, const Rgb8& color, int tolerance) {
  int sum[3] = {};
  for (int32_t i = 0; i < 64; ++i) {
    uint8_t row[32] = {};
    store_pixel(row, i % 8, i / 8, format, color);
    const Rgb8 shown = load_pixel(row, i % 8, i / 8, format);
    sum[0] += shown.r;
    sum[1] += shown.g;
    sum[2] += shown.b;
  }
  const int wanted[3] = {color.r, color.g, color.b};
  for (int c = 0; c < 3; ++c) {
    const int error = sum[c] - 64 * wanted[c];
    THIMBLE_CHECK(error <= 64 * tolerance && -error <= 64 * tolerance);
    check.note(sum[c]);
  }
}

// The spheres of the golden frames, 61 x 37 pixels: an odd width, and a last page of five rows.
constexpr int32_t kWidth = 61;
constexpr int32_t kHeight = 37;
constexpr uint32_t kFrameBytes = 61 * 2 * 16;

// Of the first format in three widths, of the others in two.
void golden_frame(Check& check, int index) {
  const int number = index < 3 ? 0 : (index - 1) / 2;
  const int way = index < 3 ? index : (index - 1) % 2;
  const PixelFormat format = kFormats[number];
  constexpr int32_t kRows[] = {8, 16, 8};
  constexpr Width kWidths[] = {Width::k64, Width::k32, Width::kAuto};
  golden::Frame frame{"panel",
                      golden::SceneId::kSpheres,
                      true,
                      {1400, -2100, 1800},
                      {256 * 16, 256 * 16, 256 * 14},
                      {},
                      60,
                      0,
                      ShadeMode::kColor,
                      format,
                      kWidth,
                      kHeight,
                      true};
  THIMBLE_REQUIRE_OK(CompactTree::open(golden_tree(frame.scene), &check.world.compact));
  check.world.structure = golden::Structure::kCompact;
  THIMBLE_REQUIRE_OK(golden::set_up(frame, &check.camera, &check.shading));
  const Bytes band = check.arena.take(thimble::band_bytes(format, kWidth, kRows[way]));
  uint32_t crc = 0;
  THIMBLE_REQUIRE_OK(golden::frame_crc32(frame, check.world, check.camera, check.shading, kWidths[way],
                                         kRows[way], band, &crc, &check.counts));
  THIMBLE_EQUAL(crc, golden::kPanelTable[number].crc32);
}

constexpr Case kCases[] = {
    {"bits_per_pixel, row_bytes of panels -> as the layouts say", 0,
     [](Check& check, int) {
       constexpr int kBits[] = {16, 16, 12, 1, 4, 2, 2, 4, 8};
       constexpr size_t kBytesOf13[] = {26, 26, 20, 13, 7, 4, 4, 7, 13};
       for (int i = 0; i < kFormatCount; ++i) {
         THIMBLE_EQUAL(bits_per_pixel(kFormats[i]), kBits[i]);
         THIMBLE_EQUAL(static_cast<int>(row_bytes(kFormats[i], 13)), static_cast<int>(kBytesOf13[i]));
         THIMBLE_EQUAL(static_cast<int>(row_bytes(kFormats[i], 0)), 0);
       }
     }},
    {"band_bytes of pages -> whole pages, a byte a column", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(static_cast<int>(band_bytes(PixelFormat::kMono1Pages, 128, 64)), 1024);
       THIMBLE_EQUAL(static_cast<int>(band_bytes(PixelFormat::kMono1Pages, 84, 48)), 504);
       THIMBLE_EQUAL(static_cast<int>(band_bytes(PixelFormat::kMono1Pages, 61, 37)), 305);
       THIMBLE_EQUAL(static_cast<int>(band_bytes(PixelFormat::kMono1Pages, 61, 1)), 61);
       THIMBLE_EQUAL(static_cast<int>(band_bytes(PixelFormat::kMono1Pages, 61, 0)), 0);
       THIMBLE_EQUAL(whole_rows(PixelFormat::kMono1Pages, 9), 16);
       THIMBLE_EQUAL(whole_rows(PixelFormat::kRgb444, 9), 9);
     }},
    {"paper3: a byte of white, a byte of red", 0,
     [](Check& check, int) {
       const Rgb8 colors[] = {kWhite, kRed, kBlack, kWhite, kRed, kBlack, kBlack, kBlack, kRed};
       const uint8_t wanted[] = {0x90, 0x48, 0x00, 0x80};
       expect_row(check, PixelFormat::kPaper3, colors, 0, wanted, THIMBLE_WHAT("paper3"));
     }},
    {"paper7: its colours -> their numbers, at every place", 0,
     [](Check& check, int) {
       const uint8_t wanted[] = {0x01, 0x23, 0x45, 0x60};
       for (int32_t y = 0; y < 8; ++y) {
         expect_row(check, PixelFormat::kPaper7, kSeven, y, wanted, THIMBLE_WHAT("paper7"));
       }
       for (int32_t i = 0; i < 64 * 7; ++i) {
         uint8_t row[8] = {};
         store_pixel(row, i % 8, i / 8 % 8, PixelFormat::kPaper7, kSeven[i / 64]);
         THIMBLE_EQUAL(load_pixel(row, i % 8, i / 8 % 8, PixelFormat::kPaper7), kSeven[i / 64]);
       }
     }},
    {"white rows of any width -> white, cleared -> nothing", 0, white_rows, 0, "format", 9},
    {"dithers of greys -> the grey on average, within 1 of 64", 0,
     [](Check& check, int) {
       for (int value = 0; value < 256; value += 5) {
         mean_of_cell(check, PixelFormat::kMono1Pages, gray(value), 4);
         mean_of_cell(check, PixelFormat::kGray2, gray(value), 2);
         mean_of_cell(check, PixelFormat::kPaper3, gray(value), 4);
         mean_of_cell(check, PixelFormat::kPaper7, gray(value), 4);
       }
     }},
    {"paper3: pink -> white and red; paper7: what seven colours mix -> that colour", 0,
     [](Check& check, int) {
       mean_of_cell(check, PixelFormat::kPaper3, {255, 128, 128}, 4);
       mean_of_cell(check, PixelFormat::kPaper3, {200, 40, 40}, 4);
       const Rgb8 mixed[] = {{255, 200, 0}, {255, 60, 0},   {200, 150, 90}, {90, 200, 90},
                             {90, 90, 200}, {210, 120, 60}, {130, 180, 20}, {240, 128, 120}};
       for (const Rgb8& color : mixed) {
         mean_of_cell(check, PixelFormat::kPaper7, color, 4);
       }
       for (int value = 0; value < 256; value += 15) {  // no cyan, no magenta: their primaries in turns
         for (int32_t i = 0; i < 64; ++i) {
           uint8_t row[8] = {};
           store_pixel(row, i % 8, i / 8, PixelFormat::kPaper7,
                       {0, static_cast<uint8_t>(value), static_cast<uint8_t>(value)});
           check.note_bytes({row, 4});
         }
       }
     }},
    {"golden frame -> its CRC", kFrameBytes, golden_frame, 0, "format and width", 19},
};

}  // namespace

const Group kPanelGroup = group_of<kCases>("panel", "cases_panels.cpp");

}  // namespace thimble::portable
