// How two cores share the bands of a frame (apps/band_crew.h), by two threads and a display that reads a band while others
// are drawn. `make test-threads` watches what they touch.
#include "apps/band_crew.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "thimble/base/memory.h"

namespace thimble {
namespace {

using apps::CrewFrame;

constexpr std::int32_t kCrewWidthPx = 48;
constexpr std::int32_t kCrewBandRows = 8;

struct ThreadLock {
  static std::mutex& mutex() {
    static std::mutex only;
    return only;
  }
  static void lock() { mutex().lock(); }
  static void unlock() { mutex().unlock(); }
};

std::uint8_t crew_pixel(std::uint32_t frame, std::int32_t row, std::int32_t column) {
  return static_cast<std::uint8_t>(frame * 31 + static_cast<std::uint32_t>(row * 7 + column));
}

// Bands as far as the eye sees: what begin_flush was given is read by a thread of its own, byte by byte.
class ReadingDisplay {
 public:
  explicit ReadingDisplay(std::int32_t height_px)
      : picture_(static_cast<std::size_t>(height_px) * kCrewWidthPx),
        times_(static_cast<std::size_t>(height_px)) {}
  ~ReadingDisplay() { await(); }
  ReadingDisplay(const ReadingDisplay&) = delete;
  ReadingDisplay& operator=(const ReadingDisplay&) = delete;

  void await() {
    if (reader_.joinable()) {
      reader_.join();
    }
  }
  void begin(const std::uint8_t* bytes, std::int32_t row, std::int32_t rows) {
    await();
    for (std::int32_t i = 0; i < rows; ++i) {
      ++times_[static_cast<std::size_t>(row) + static_cast<std::size_t>(i)];
    }
    order_.push_back(row);
    reader_ = std::thread([this, bytes, row, rows] {
      for (std::int32_t i = 0; i < rows * kCrewWidthPx; ++i) {
        if (i % (4 * kCrewWidthPx) == 0) {
          std::this_thread::sleep_for(std::chrono::microseconds(20));
        }
        picture_[static_cast<std::size_t>(row) * kCrewWidthPx + static_cast<std::size_t>(i)] = bytes[i];
      }
    });
  }

  const std::vector<std::uint8_t>& picture() const { return picture_; }
  const std::vector<int>& times() const { return times_; }
  std::vector<std::int32_t>& order() { return order_; }

 private:
  std::vector<std::uint8_t> picture_;
  std::vector<int> times_;
  std::vector<std::int32_t> order_;  // the first rows of the bands
  std::thread reader_;
};

struct CrewRun {
  std::int32_t height_px = 0;
  bool in_order = false;
  std::int32_t fails_at = -1;  // the band from this row on cannot be drawn
  CrewFrame frame;
  std::vector<std::uint8_t> memory =
      std::vector<std::uint8_t>(std::size_t{CrewFrame::kMemories} * kCrewWidthPx * kCrewBandRows);
  std::uint32_t number = 0;
  std::uint32_t crc = 0;
  std::atomic<int> bands[2] = {0, 0};  // of each core
  bool awaits_other = false;

  std::uint8_t* place(std::uint8_t index) {
    return memory.data() + std::size_t{index} * kCrewWidthPx * kCrewBandRows;
  }
  void share(int core, ReadingDisplay* display) {
    apps::draw_share<ThreadLock>(
        &frame, core,
        [&](std::uint8_t index, std::int32_t row, std::int32_t rows) {
          ++bands[core];
          for (std::int32_t i = 0; i < rows * kCrewWidthPx; ++i) {
            place(index)[i] = crew_pixel(number, row + i / kCrewWidthPx, i % kCrewWidthPx);
          }
          // A machine with other work may start a thread when the other has drawn all: the first one waits for it.
          for (int ms = 0; core == 0 && awaits_other && bands[1] == 0 && ms < 60000; ++ms) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
          }
          // Now one core is slower, now the other.
          std::this_thread::sleep_for(
              std::chrono::microseconds((row / 8 + core + static_cast<int>(number)) % 3 * 60));
          return row == fails_at ? Status::kDamaged : Status::kOk;
        },
        [&](std::uint8_t index, std::int32_t row, std::int32_t rows) {
          display->begin(place(index), row, rows);
          crc = crc32({place(index), static_cast<std::size_t>(rows * kCrewWidthPx)}, crc);
        });
  }
  // By as many cores.
  Status draw(int cores, ReadingDisplay* display) {
    frame.height_px = height_px;
    frame.band_rows = kCrewBandRows;
    frame.in_order = in_order;
    frame.begin();
    crc = 0;
    std::thread other;
    awaits_other = cores > 1 && height_px > kCrewBandRows;
    if (cores > 1) {
      other = std::thread([&] { share(1, display); });
    }
    share(0, display);
    if (other.joinable()) {
      other.join();
    }
    return frame.status;
  }
};

// Each memory has one user: a core, or the display.
bool are_apart(const CrewFrame& frame) {
  return frame.sending != frame.drawing[0] && frame.sending != frame.drawing[1] &&
         frame.drawing[0] != frame.drawing[1];
}

}  // namespace

TEST_CASE("two cores: each band once, the picture of one core, nothing written that the display reads") {
  for (const std::int32_t height_px : {8, 60, 123}) {
    for (const bool in_order : {false, true}) {
      CAPTURE(height_px);
      CAPTURE(in_order);
      CrewRun run;
      run.height_px = height_px;
      run.in_order = in_order;
      for (run.number = 0; run.number < 40; ++run.number) {
        ReadingDisplay display(height_px);
        REQUIRE(run.draw(run.number % 5 == 4 ? 1 : 2, &display) == Status::kOk);
        display.await();
        REQUIRE(are_apart(run.frame));
        std::vector<std::uint8_t> wanted;
        wanted.reserve(display.picture().size());
        for (std::int32_t i = 0; i < height_px * kCrewWidthPx; ++i) {
          wanted.push_back(crew_pixel(run.number, i / kCrewWidthPx, i % kCrewWidthPx));
        }
        REQUIRE(display.picture() == wanted);
        REQUIRE(display.times() == std::vector<int>(static_cast<std::size_t>(height_px), 1));
        if (in_order) {
          REQUIRE(std::is_sorted(display.order().begin(), display.order().end()));
          REQUIRE(run.crc == crc32({wanted.data(), wanted.size()}));
        }
      }
      const int a_frame = (height_px + kCrewBandRows - 1) / kCrewBandRows;
      CHECK(run.bands[0] + run.bands[1] == 40 * a_frame);
      // Both had work, where there are bands for both; how much is the machine's affair.
      if (height_px > kCrewBandRows) {
        CHECK(run.bands[0] > 0);
        CHECK(run.bands[1] > 0);
      }
    }
  }
}

TEST_CASE("two cores: a band that cannot be drawn ends the frame for both, and the next frame is whole") {
  for (const bool in_order : {false, true}) {
    CAPTURE(in_order);
    CrewRun run;
    run.height_px = 96;
    run.in_order = in_order;
    for (run.number = 0; run.number < 24; ++run.number) {
      run.fails_at = static_cast<std::int32_t>(run.number % 12) * kCrewBandRows;
      ReadingDisplay broken(run.height_px);
      REQUIRE(run.draw(2, &broken) == Status::kDamaged);
      REQUIRE(broken.times()[static_cast<std::size_t>(run.fails_at)] == 0);
      REQUIRE(are_apart(run.frame));
      broken.await();
      run.fails_at = -1;
      ReadingDisplay whole(run.height_px);
      REQUIRE(run.draw(2, &whole) == Status::kOk);
      REQUIRE(whole.times() == std::vector<int>(static_cast<std::size_t>(run.height_px), 1));
    }
  }
}

TEST_CASE("two cores: after a band that one core has sent alone, its memory is left to the display") {
  for (std::uint8_t memory = 0; memory < CrewFrame::kMemories; ++memory) {
    CrewFrame frame;
    frame.begin_after(memory);
    CHECK(frame.sending == memory);
    CHECK(are_apart(frame));
  }
}

}  // namespace thimble
