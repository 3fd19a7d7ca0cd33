// Moving water: what holds after every step (energy, volume, limits, symmetry, a plain second version of the
// step), and what it does.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/counts.h"
#include "thimble/light/water.h"

namespace thimble::tools {
namespace {

__extension__ typedef __int128 Wide;

const int kShare = thimble::tests::many_or_few(1, 10);

// A pool with its bytes and its mask.
struct Pool {
  WaterConfig config;
  std::vector<std::uint8_t> mask;
  std::vector<std::uint8_t> bytes;
  Water water;

  Pool() = default;
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  Status open() {
    config.blocked = {mask.data(), mask.size()};
    bytes.assign(water_bytes(config.width, config.depth), 0xA5);
    return Water::make(config, {bytes.data(), bytes.size()}, &water);
  }
  void block(std::int32_t x, std::int32_t y) {
    mask.resize((static_cast<std::size_t>(config.width) * static_cast<std::size_t>(config.depth) + 7) / 8);
    const auto bit = static_cast<std::uint32_t>(y * config.width + x);
    mask[bit / 8] = static_cast<std::uint8_t>(mask[bit / 8] | (1U << (bit % 8)));
  }
};

void make_pool(Pool& pool, std::int32_t width, std::int32_t depth, std::int32_t rest_q8 = 8 * 256,
               std::int32_t greatest_q8 = 16 * 256) {
  pool.config.width = width;
  pool.config.depth = depth;
  pool.config.rest_q8 = rest_q8;
  pool.config.greatest_q8 = greatest_q8;
}

// The state, copied out, and the same step without spans, sleep or 32 bits: every edge, then every column.
struct Plain {
  std::int32_t width = 0;
  std::int32_t depth = 0;
  std::vector<std::int64_t> height;  // -1: blocked
  std::vector<std::int64_t> flux[2];

  explicit Plain(const Water& water) : width(water.width()), depth(water.depth()) {
    for (std::int32_t y = 0; y < depth; ++y) {
      for (std::int32_t x = 0; x < width; ++x) {
        height.push_back(water.height_q16(x, y));
        flux[0].push_back(water.flux_q16(0, x, y));
        flux[1].push_back(water.flux_q16(1, x, y));
      }
    }
  }
  std::size_t at(std::int32_t x, std::int32_t y) const { return static_cast<std::uint32_t>(y * width + x); }
  // Calls visit(axis, column, neighbour) for each edge between two columns that hold water.
  template <class Visit>
  void edges(Visit visit) const {
    for (std::int32_t y = 0; y < depth; ++y) {
      for (std::int32_t x = 0; x < width; ++x) {
        if (height[at(x, y)] >= 0 && x + 1 < width && height[at(x + 1, y)] >= 0) {
          visit(0, at(x, y), at(x + 1, y));
        }
        if (height[at(x, y)] >= 0 && y + 1 < depth && height[at(x, y + 1)] >= 0) {
          visit(1, at(x, y), at(x, y + 1));
        }
      }
    }
  }
  void step(const WaterConfig& config) {
    const std::int64_t speed = std::int64_t{config.wave_speed_q6} * config.wave_speed_q6;
    const std::int64_t steepest = (std::int64_t{65534} * 4096 + speed - 1) / speed;
    const std::int64_t least = std::int64_t{256} * config.least_q8;
    const std::int64_t greatest = std::int64_t{256} * config.greatest_q8;
    edges([&](int axis, std::size_t a, std::size_t b) {
      std::int64_t& q = flux[axis][a];
      const std::int64_t fall = std::clamp(height[a] - height[b], -steepest, steepest);
      const std::int64_t both = 2 * q * 4096 + speed * fall;
      const std::int64_t size = std::llabs(both);
      const std::int64_t kept = (size - size / 1024 * config.damping_q12 / 4) / 4096;
      const std::int64_t wanted = (both < 0 ? -kept : kept) - q;
      const std::int64_t most =
          std::min({(height[a] - least) / 4, (greatest - height[b]) / 4, std::int64_t{32767}});
      const std::int64_t least_flux =
          -std::min({(height[b] - least) / 4, (greatest - height[a]) / 4, std::int64_t{32767}});
      q = std::clamp(wanted, least_flux, most);
    });
    edges([&](int axis, std::size_t a, std::size_t b) {
      height[a] -= flux[axis][a];
      height[b] += flux[axis][a];
    });
  }
  friend bool operator==(const Plain& a, const Plain& b) {
    return a.height == b.height && a.flux[0] == b.flux[0] && a.flux[1] == b.flux[1];
  }

  // The energy that src/light/WATER.md proves not to grow, times 4096: |q|^2 + k |h|^2 + k q.(Gh).
  Wide energy(const WaterConfig& config) const {
    const Wide speed = std::int64_t{config.wave_speed_q6} * config.wave_speed_q6;
    Wide sum = 0;
    for (const std::int64_t h : height) {
      if (h >= 0) {
        const Wide above = h - std::int64_t{256} * config.rest_q8;
        sum += speed * above * above;
      }
    }
    edges([&](int axis, std::size_t a, std::size_t b) {
      const Wide q = flux[axis][a];
      sum += 4096 * q * q + speed * q * (height[a] - height[b]);
    });
    return sum;
  }
  // Volume of each basin, the basins by the number of their first column.
  std::vector<std::pair<std::size_t, std::int64_t>> basins() const {
    std::vector<std::size_t> root(height.size());
    for (std::size_t i = 0; i < root.size(); ++i) {
      root[i] = i;
    }
    const std::function<std::size_t(std::size_t)> find = [&](std::size_t i) {
      while (root[i] != i) {
        root[i] = root[root[i]];
        i = root[i];
      }
      return i;
    };
    edges([&](int, std::size_t a, std::size_t b) {
      const std::size_t low = std::min(find(a), find(b));
      const std::size_t high = std::max(find(a), find(b));
      root[high] = low;
    });
    std::vector<std::int64_t> volume(height.size(), 0);
    for (std::size_t i = 0; i < height.size(); ++i) {
      volume[find(i)] += std::max<std::int64_t>(height[i], 0);
    }
    std::vector<std::pair<std::size_t, std::int64_t>> all;
    for (std::size_t i = 0; i < height.size(); ++i) {
      if (root[i] == i && height[i] >= 0) {
        all.emplace_back(i, volume[i]);
      }
    }
    return all;
  }
  // What is wrong with the bounds that the view gives; empty when nothing is.
  std::string fault(const Water& water, const WaterConfig& config) const {
    std::int64_t least = INT64_MAX;
    std::int64_t greatest = -1;
    for (const std::int64_t h : height) {
      if (h >= 0) {
        least = std::min(least, h);
        greatest = std::max(greatest, h);
      }
    }
    if (greatest < 0) {
      return "";
    }
    if (least < std::int64_t{256} * config.least_q8 || greatest > std::int64_t{256} * config.greatest_q8) {
      return "a height beyond its limits";
    }
    if (water.lowest_q8() > (least + 128) >> 8 || water.highest_q8() < (greatest + 128) >> 8) {
      return "lowest_q8 and highest_q8 do not hold all heights";
    }
    return "";
  }
};

void make_random_pool(Pool& pool, std::mt19937& random) {
  const auto below = [&random](int limit) {
    return static_cast<std::int32_t>(random() % static_cast<unsigned>(limit));
  };
  make_pool(pool, 1 + below(below(3) == 0 ? 4 : 24), 1 + below(below(3) == 0 ? 4 : 24));
  pool.config.wave_speed_q6 = below(3) == 0 ? kMaxWaveSpeedQ6 : kMinWaveSpeedQ6 + below(25);
  pool.config.damping_q12 = below(3) == 0 ? 0 : below(4) == 0 ? below(2049) : below(60);
  switch (below(4)) {
    case 0:  // tight
      pool.config.least_q8 = below(1000);
      pool.config.rest_q8 = pool.config.least_q8 + below(40);
      pool.config.greatest_q8 = pool.config.rest_q8 + below(40);
      break;
    case 1:  // as much room as there is
      pool.config.rest_q8 = below(kMaxWaterHeightQ8);
      pool.config.greatest_q8 = kMaxWaterHeightQ8;
      break;
    default:
      pool.config.rest_q8 = 256 * (1 + below(8));
      pool.config.greatest_q8 = pool.config.rest_q8 + 256 * below(8);
      break;
  }
  const int one_in = below(3) == 0 ? 0 : 2 + below(10);
  for (std::int32_t y = 0; one_in != 0 && y < pool.config.depth; ++y) {
    for (std::int32_t x = 0; x < pool.config.width; ++x) {
      if (below(one_in) == 0) {
        pool.block(x, y);
      }
    }
  }
}

void disturb(Pool& pool, std::mt19937& random) {
  const auto between = [&random](std::int32_t low, std::int32_t high) {
    return low + static_cast<std::int32_t>(random() % static_cast<unsigned>(high - low + 1));
  };
  const std::int32_t x = between(-400, 256 * pool.config.width + 400);
  const std::int32_t y = between(-400, 256 * pool.config.depth + 400);
  const std::int32_t radius = between(0, between(0, 3) == 0 ? 1 << 14 : 1600);
  if (between(0, 1) == 0) {
    const std::int32_t depth = between(0, 4) == 0 ? 1 << 14 : between(0, 3000);
    REQUIRE(pool.water.touch(x, y, radius, between(0, 1) == 0 ? depth : -depth) == Status::kOk);
  } else {
    const std::int32_t mass = between(0, 4) == 0 ? 1 << 20 : between(0, 3000);
    REQUIRE(pool.water.drop(x, y, radius, mass, between(-1 << 16, 1 << 16) / between(1, 300)) == Status::kOk);
  }
}

TEST_CASE("water: pools of every kind -> energy never grows, volume and limits are kept, after every step") {
  const int pools = 1200 / kShare;
  int rested = 0;
  int clamped = 0;
  for (int number = 0; number < pools; ++number) {
    CAPTURE(number);
    std::mt19937 random(static_cast<unsigned>(number) * 7919U + 5);
    Pool pool;
    make_random_pool(pool, random);
    REQUIRE(pool.open() == Status::kOk);
    const auto basins = Plain(pool.water).basins();
    Wide energy = 0;
    for (int step = 0; step < 80; ++step) {
      CAPTURE(step);
      if (step < 3 || random() % 32 == 0) {
        disturb(pool, random);
        const Plain now(pool.water);
        energy = now.energy(pool.config);
        REQUIRE(now.basins() == basins);
        REQUIRE(now.fault(pool.water, pool.config) == "");
      }
      Plain wanted(pool.water);
      const bool was_still = pool.water.is_still();
      pool.water.step();
      const Plain now(pool.water);
      rested += pool.water.is_still() && !was_still ? 1 : 0;
      for (const std::int64_t q : now.flux[0]) {
        clamped += std::llabs(q) == 32767 ? 1 : 0;
      }
      const Wide next = now.energy(pool.config);
      REQUIRE(next >= 0);
      REQUIRE(next <= energy);
      energy = next;
      REQUIRE(now.basins() == basins);
      REQUIRE(now.fault(pool.water, pool.config) == "");
      if (!pool.water.is_still() || was_still) {
        if (!was_still) {
          wanted.step(pool.config);
        }
        REQUIRE(now == wanted);
      }
    }
  }
  CHECK(rested > 10 / kShare);
  CHECK(clamped > 1000 / kShare);
}

TEST_CASE(
    "water: about to be laid flat -> nothing that can be seen is left, or the bound of WATER.md holds") {
  for (const std::int32_t damping : {0, 4, 24, 200}) {
    for (const std::int32_t speed : {kMinWaveSpeedQ6, 20, kMaxWaveSpeedQ6}) {
      CAPTURE(damping);
      CAPTURE(speed);
      Pool pool;
      make_pool(pool, 30, 22);
      pool.config.damping_q12 = damping;
      pool.config.wave_speed_q6 = speed;
      REQUIRE(pool.open() == Status::kOk);
      REQUIRE(pool.water.touch(256 * 9 + 3, 256 * 13 + 77, 1000, 500) == Status::kOk);
      std::int64_t before = 0;
      for (int step = 0; step < 30000 && !pool.water.is_still(); ++step) {
        before = 0;
        for (std::int32_t y = 0; y < 22; ++y) {
          for (std::int32_t x = 0; x < 30; ++x) {
            before = std::max<std::int64_t>(before, std::abs(pool.water.height_q16(x, y) - 8 * 65536));
          }
        }
        pool.water.step();
      }
      if (damping != 0) {
        REQUIRE(pool.water.is_still());
        // Twice kStill for the last step, or a slope of at most 6 / k a column over the way across.
        CHECK(before <= std::max<std::int64_t>(512, 6 * 4096 / (speed * speed) * 52));
        CHECK(before <= 512);  // what is seen in practice: two units of what can be seen
      }
    }
  }
}

TEST_CASE("water: two columns that swing -> a turn that falls between two steps is not taken for rest") {
  int turns = 0;
  for (std::int32_t depth = 1; depth <= 3000; ++depth) {
    CAPTURE(depth);
    Pool pool;
    make_pool(pool, 2, 1);
    REQUIRE(pool.open() == Status::kOk);
    REQUIRE(pool.water.touch(128, 128, 384, depth) == Status::kOk);
    for (int step = 0; step < 200 && !pool.water.is_still(); ++step) {
      const std::int32_t flux = pool.water.flux_q16(0, 0, 0);
      const std::int32_t height = std::abs(pool.water.height_q16(0, 0) - 8 * 65536);
      pool.water.step();
      turns += flux != 0 && pool.water.flux_q16(0, 0, 0) == -flux && height > 256 ? 1 : 0;
      if (pool.water.is_still()) {
        REQUIRE(height <= 128);
      }
    }
  }
  CHECK(turns > 0);
}

TEST_CASE("water: a touch -> sinks as deep as asked, rises around, nothing is lost") {
  Pool pool;
  make_pool(pool, 40, 40);
  for (const std::int32_t radius : {384, 512, 1000, 2560, 4000}) {
    for (const std::int32_t depth : {1, 64, 300, -300}) {
      CAPTURE(radius);
      CAPTURE(depth);
      REQUIRE(pool.open() == Status::kOk);
      const std::uint64_t volume = pool.water.volume_q16();
      REQUIRE(pool.water.touch(20 * 256 + 128, 20 * 256 + 128, radius, depth) == Status::kOk);
      CHECK(!pool.water.is_still());
      CHECK(pool.water.volume_q16() == volume);
      CHECK(pool.water.height_q8(20, 20) == 8 * 256 - depth);
      std::int32_t rim = 0;
      for (std::int32_t x = 0; x < 40; ++x) {
        const std::int32_t rise = pool.water.height_q16(x, 20) - 8 * 65536;
        rim = std::max(rim, depth > 0 ? rise : -rise);
      }
      CHECK(rim > std::abs(depth) * 256 / 12);
      CHECK(rim < std::abs(depth) * 256);
      CHECK(pool.water.steps_done() == 0);
    }
  }
}

TEST_CASE(
    "water: a touch that raises columns to the very limit -> as without a limit; 1/256 less -> less deep") {
  int found = 0;
  for (std::int32_t depth = 64; depth < 1600 && found < 3; ++depth) {
    const auto touch = [&](std::int32_t greatest_q8, Pool* pool) {
      make_pool(*pool, 9, 9, 2048, greatest_q8);
      REQUIRE(pool->open() == Status::kOk);
      REQUIRE(pool->water.touch(4 * 256 + 128, 4 * 256 + 128, 512, depth) == Status::kOk);
    };
    Pool free;
    touch(4096, &free);
    const Plain wanted(free.water);
    const std::int64_t most = *std::max_element(wanted.height.begin(), wanted.height.end());
    if (most % 256 != 0) {
      continue;
    }
    ++found;
    Pool limited;
    touch(static_cast<std::int32_t>(most / 256), &limited);
    CHECK(Plain(limited.water).height == wanted.height);
    Pool lower;
    touch(static_cast<std::int32_t>(most / 256) - 1, &lower);
    CHECK(Plain(lower.water).height != wanted.height);
  }
  CHECK(found == 3);
}

TEST_CASE("water: a thing falls in -> the water yields under it and rises around, more with more momentum") {
  std::int32_t dip[2] = {0, 0};
  for (int heavy = 0; heavy < 2; ++heavy) {
    Pool pool;
    make_pool(pool, 41, 41);
    REQUIRE(pool.open() == Status::kOk);
    REQUIRE(pool.water.drop(20 * 256 + 128, 20 * 256 + 128, 768, heavy == 0 ? 256 : 1024, 128) ==
            Status::kOk);
    CHECK(pool.water.height_q8(20, 20) == 8 * 256);
    for (int step = 0; step < 3; ++step) {
      pool.water.step();
    }
    dip[heavy] = 8 * 65536 - pool.water.height_q16(20, 20);
    CHECK(dip[heavy] > 256);
    CHECK(pool.water.height_q16(24, 20) > 8 * 65536);
  }
  CHECK(dip[1] > 3 * dip[0]);
  CHECK(dip[1] < 5 * dip[0]);
}

TEST_CASE("water: a wave in a channel -> runs with the speed given") {
  for (const std::int32_t speed : {16, 24, 32}) {
    CAPTURE(speed);
    Pool pool;
    make_pool(pool, 400, 1);
    pool.config.wave_speed_q6 = speed;
    pool.config.damping_q12 = 0;
    REQUIRE(pool.open() == Status::kOk);
    REQUIRE(pool.water.touch(200 * 256 + 128, 128, 10 * 256, 100) == Status::kOk);
    const auto deepest = [&pool] {
      std::int32_t best = 0;
      for (std::int32_t x = 0; x < 200; ++x) {
        best = pool.water.height_q16(x, 0) < pool.water.height_q16(best, 0) ? x : best;
      }
      return best;
    };
    for (int step = 0; step < 100; ++step) {
      pool.water.step();
    }
    const std::int32_t early = deepest();
    for (int step = 0; step < 200; ++step) {
      pool.water.step();
    }
    const double columns_a_step = (early - deepest()) / 200.0;
    CHECK(columns_a_step == doctest::Approx(speed / 64.0).epsilon(0.03));
  }
}

TEST_CASE("water: a small touch in a large pool -> only columns near it are worked on") {
  Pool pool;
  make_pool(pool, 256, 256);
  REQUIRE(pool.open() == Status::kOk);
  REQUIRE(pool.water.touch(100 * 256, 50 * 256, 512, 100) == Status::kOk);
  for (std::uint64_t step = 1; step <= 40; ++step) {
    const std::uint64_t before = pool.water.columns_updated();
    pool.water.step();
    const std::uint64_t reach = 2 * (5 + step);
    CHECK(pool.water.columns_updated() - before <= reach * reach);
    CHECK(pool.water.columns_updated() > before);
  }
}

TEST_CASE("water: set-up beyond the limits -> refused, the stability limit too, and nothing is changed") {
  const auto status = [](const std::function<void(Pool&)>& change) {
    Pool pool;
    make_pool(pool, 8, 8);
    change(pool);
    const Status answer = pool.open();
    if (answer != Status::kOk) {
      CHECK(pool.water.width() == 0);
      for (const std::uint8_t byte : pool.bytes) {
        REQUIRE(byte == 0xA5);
      }
    }
    return answer;
  };
  const Status range = Status::kOutOfRange;
  CHECK(status([](Pool&) {}) == Status::kOk);
  CHECK(status([](Pool& p) { p.config.wave_speed_q6 = kMaxWaveSpeedQ6; }) == Status::kOk);
  CHECK(status([](Pool& p) { p.config.wave_speed_q6 = kMaxWaveSpeedQ6 + 1; }) == range);
  CHECK(status([](Pool& p) { p.config.wave_speed_q6 = INT32_MAX; }) == range);
  CHECK(status([](Pool& p) { p.config.wave_speed_q6 = kMinWaveSpeedQ6 - 1; }) == range);
  CHECK(status([](Pool& p) { p.config.damping_q12 = -1; }) == range);
  CHECK(status([](Pool& p) { p.config.damping_q12 = 2049; }) == range);
  CHECK(status([](Pool& p) { p.config.least_q8 = -1; }) == range);
  CHECK(status([](Pool& p) { p.config.least_q8 = p.config.rest_q8 + 1; }) == range);
  CHECK(status([](Pool& p) { p.config.greatest_q8 = p.config.rest_q8 - 1; }) == range);
  CHECK(status([](Pool& p) { p.config.greatest_q8 = kMaxWaterHeightQ8 + 1; }) == range);
  CHECK(status([](Pool& p) { p.config.width = 0; }) == range);
  CHECK(status([](Pool& p) { p.config.width = kMaxWaterSide + 1; }) == range);
  CHECK(status([](Pool& p) { p.config.depth = -1; }) == range);
  CHECK(status([](Pool& p) { p.mask.resize(7); }) == Status::kBadArgument);
  CHECK(status([](Pool& p) { p.mask.resize(9); }) == Status::kBadArgument);
  CHECK(status([](Pool& p) { p.mask.resize(8); }) == Status::kOk);
}

}  // namespace
}  // namespace thimble::tools
