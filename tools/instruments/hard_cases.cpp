#include "instruments/hard_cases.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "output/units.h"
#include "reference/reference.h"
#include "reference/textbook.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {
namespace {

using Components = std::array<std::int64_t, 3>;

// A world of random voxels, for the core, the reference and the textbooks.
struct CaseWorld {
  int level;
  std::vector<std::uint64_t> keys;  // of the compact tree's voxels
  reference::BitGrid grid;
  reference::Pyramid pyramid;
  std::vector<std::uint8_t> bytes;
  CompactTree tree;

  CaseWorld(int log2_side, int one_in, std::uint64_t seed)
      : level(log2_side), grid(filled(log2_side, one_in, seed, &keys)), pyramid(grid) {
    std::sort(keys.begin(), keys.end());
    std::size_t needed = 0;
    const Span<const std::uint64_t> sorted{keys.data(), keys.size()};
    (void)CompactTree::make(sorted, level, Bytes{}, nullptr, &needed);
    bytes.resize(needed);
    if (CompactTree::make(sorted, level, {bytes.data(), bytes.size()}, &tree) != Status::kOk) {
      throw std::logic_error("the world of the hard cases has no tree");
    }
  }
  CaseWorld(const CaseWorld&) = delete;

 private:
  static reference::BitGrid filled(int log2_side, int one_in, std::uint64_t seed,
                                   std::vector<std::uint64_t>* keys) {
    const int side = 1 << log2_side;
    reference::BitGrid grid({side, side, side});
    Draw draw(seed);
    for (int z = 0; z < side; ++z) {
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          if (draw.from(1, one_in) == 1) {
            grid.set({x, y, z});
            keys->push_back(morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                        static_cast<std::uint32_t>(z))
                            << 8);
          }
        }
      }
    }
    return grid;
  }
};

// --- The cases. `side` is that of the world in voxels, positions are in 1/256 voxel.

constexpr std::int64_t kOneQ8 = 256;

Components any_direction(Draw& draw) {
  Components direction{};
  while (direction == Components{}) {
    for (std::int64_t& component : direction) {
      component = draw.from(-32767, 32767);
    }
  }
  return direction;
}

// The number x of 1 .. modulus for which value * x leaves the rest 1; the two have no common divisor.
std::int64_t inverse(std::int64_t value, std::int64_t modulus) {
  std::int64_t rest = modulus;
  std::int64_t next_rest = value % modulus;
  std::int64_t x = 0;
  std::int64_t next_x = 1;
  while (next_rest != 0) {
    const std::int64_t quotient = rest / next_rest;
    rest -= quotient * next_rest;
    x -= quotient * next_x;
    std::swap(rest, next_rest);
    std::swap(x, next_x);
  }
  return x < 0 ? x + modulus : x;
}

Components corner(Draw& draw, std::int64_t side) {
  return {kOneQ8 * draw.from(0, side), kOneQ8 * draw.from(0, side), kOneQ8 * draw.from(0, side)};
}
Components inside(Draw& draw, std::int64_t side) {
  return {draw.from(0, kOneQ8 * side - 1), draw.from(0, kOneQ8 * side - 1), draw.from(0, kOneQ8 * side - 1)};
}

// From one side of the world or the other, on a line of corners along `axis`.
Components beside_world(Draw& draw, std::int64_t side, std::size_t axis) {
  Components origin = corner(draw, side);
  origin[axis] = draw.sign() < 0 ? -kOneQ8 * side : kOneQ8 * 2 * side;
  return origin;
}

reference::Ray any_ray(Draw& draw, std::int64_t side) {
  return {inside(draw, side), any_direction(draw)};
}

// A ray exactly through the point, which begins as far before it as keeps it near the world.
reference::Ray through(Draw& draw, const Components& point, std::int64_t side) {
  Components direction{};
  std::int64_t most = 0;
  for (std::int64_t& component : direction) {
    component = draw.sign() * draw.from(1, 300);
    most = std::max(most, std::abs(component));
  }
  const std::int64_t times = draw.from(0, std::max<std::int64_t>(2 * side * kOneQ8 / most, 1));
  Components origin{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    origin[axis] = point[axis] - times * direction[axis];
  }
  return {origin, direction};
}

reference::Ray through_corner(Draw& draw, std::int64_t side) {
  return through(draw, corner(draw, side), side);
}

// Along an axis, on a line of corners; beside it by at most `kBeside` for `kAlong` on the way.
template <int kAlong, int kBeside>
reference::Ray along_axis(Draw& draw, std::int64_t side) {
  const auto axis = static_cast<std::size_t>(draw.from(0, 2));
  const Components origin = beside_world(draw, side, axis);
  Components direction{};
  for (std::size_t other = 0; kBeside != 0 && other < 3; ++other) {
    direction[other] = draw.from(-kBeside, kBeside);
  }
  direction[axis] = origin[axis] < 0 ? kAlong : -kAlong;
  return {origin, direction};
}

struct HardCase {
  const char* name;
  int level;
  reference::Ray (*make)(Draw& draw, std::int64_t side);
};

constexpr int kSmall = 6;
constexpr int kLarge = 8;

const HardCase kCases[] = {
    {"any ray", kSmall, any_ray},
    {"through an edge", kSmall,
     [](Draw& draw, std::int64_t side) {
       Components point = corner(draw, side);
       point[static_cast<std::size_t>(draw.from(0, 2))] = draw.from(0, kOneQ8 * side);
       return through(draw, point, side);
     }},
    {"through a corner", kSmall, through_corner},
    {"through a row of corners", kSmall,
     [](Draw& draw, std::int64_t side) {
       const Components point = corner(draw, side);
       const std::int64_t size = draw.from(1, 32767);
       const Components direction{draw.sign() * size, draw.sign() * size, draw.sign() * size};
       return reference::Ray{point, direction};
     }},
    {"in a face", kSmall,
     [](Draw& draw, std::int64_t side) {
       const auto axis = static_cast<std::size_t>(draw.from(0, 2));
       Components origin = inside(draw, side);
       origin[axis] = kOneQ8 * draw.from(0, side - 1);
       Components direction = any_direction(draw);
       direction[axis] = 0;
       direction[(axis + 1) % 3] = draw.from(1, 32767);
       return reference::Ray{origin, direction};
     }},
    {"in an edge", kSmall, along_axis<1, 0>},
    {"starts on a face", kSmall,
     [](Draw& draw, std::int64_t side) {
       Components origin = inside(draw, side);
       origin[static_cast<std::size_t>(draw.from(0, 2))] = kOneQ8 * draw.from(0, side);
       return reference::Ray{origin, any_direction(draw)};
     }},
    {"starts in a corner", kSmall,
     [](Draw& draw, std::int64_t side) {
       return reference::Ray{corner(draw, side), any_direction(draw)};
     }},
    {"starts a hair off a face", kSmall,
     [](Draw& draw, std::int64_t side) {
       Components origin = inside(draw, side);
       const auto axis = static_cast<std::size_t>(draw.from(0, 2));
       origin[axis] = kOneQ8 * draw.from(0, side);
       origin[axis] += draw.sign();
       return reference::Ray{origin, any_direction(draw)};
     }},
    {"almost along an axis", kSmall, along_axis<1048575, 2>},
    {"an edge, missed by the least", kSmall,
     [](Draw& draw, std::int64_t side) {
       // The order of two planes, s_a * d_b - s_b * d_a, is 1: no ray with such directions comes closer to an
       // edge without touching it.
       std::int64_t d_a = 0;
       std::int64_t d_b = 0;
       do {
         d_a = draw.from(16384, 65535);
         d_b = draw.from(16384, 65535);
       } while (std::gcd(d_a, d_b) != 1);
       const std::int64_t s_a = inverse(d_b, d_a);
       const std::int64_t s_b = (s_a * d_b - 1) / d_a;
       const auto a = static_cast<std::size_t>(draw.from(0, 2));
       const auto b = (a + static_cast<std::size_t>(draw.from(1, 2))) % 3;
       const Components point = corner(draw, side);
       Components origin = inside(draw, side);
       Components direction{};
       direction[3 - a - b] = draw.from(-300, 300);
       const std::int64_t side_a = draw.sign();
       const std::int64_t side_b = draw.sign();
       direction[a] = side_a * d_a;
       direction[b] = side_b * d_b;
       origin[a] = point[a] - side_a * s_a;
       origin[b] = point[b] - side_b * s_b;
       return reference::Ray{origin, direction};
     }},
    {"from four worlds away", kSmall,
     [](Draw& draw, std::int64_t side) {
       Components origin{};
       for (std::int64_t& component : origin) {
         component = draw.sign() < 0 ? draw.from(-4 * kOneQ8 * side, -3 * kOneQ8 * side)
                                     : draw.from(4 * kOneQ8 * side, 5 * kOneQ8 * side);
       }
       const Components target = corner(draw, side);
       Components direction{};
       for (std::size_t axis = 0; axis < 3; ++axis) {
         direction[axis] = (target[axis] - origin[axis]) / 2;
       }
       return reference::Ray{origin, direction};
     }},
    {"a large world, any ray", kLarge, any_ray},
    {"a large world, corners", kLarge, through_corner},
};

Ray core_ray(const reference::Ray& ray) {
  Ray result;
  for (int axis = 0; axis < 3; ++axis) {
    const auto index = static_cast<std::size_t>(axis);
    result.origin[axis] = Q8::from_raw(static_cast<std::int32_t>(ray.origin_q8[index]));
    result.direction[axis] = static_cast<std::int32_t>(ray.direction[index]);
  }
  return result;
}

reference::TextbookHit core_hit(const CompactTree& tree, const Ray& ray, Width width) {
  Hit hit;
  TraceOptions options;
  options.width = width;
  if (closest_hit(tree, ray, &hit, options) != Status::kOk) {
    throw std::logic_error("a hard case is not a ray");
  }
  reference::TextbookHit result;
  result.hit = hit.kind == HitKind::kHit;
  result.voxel = {hit.voxel.x, hit.voxel.y, hit.voxel.z};
  result.axis = int{hit.axis};
  return result;
}

void trace_all(const CaseWorld& world, const reference::Ray& ray, HardCaseRow* row) {
  const reference::Hit right = reference::walk(world.grid, ray);
  row->hits += right.hit ? 1 : 0;
  ++row->rays;
  const Ray own = core_ray(ray);
  std::size_t tracer = 0;
  const auto next = [&](const reference::TextbookHit& answer) {
    if (right.hit != answer.hit || (right.hit && right.voxel != answer.voxel)) {
      ++row->wrong[tracer];
    } else if (right.hit && right.axis >= 0 && right.axis != answer.axis) {
      ++row->wrong_face[tracer];
    }
    ++tracer;
  };
  next(core_hit(world.tree, own, Width::k64));
  if (accepts_32(own, world.level)) {
    next(core_hit(world.tree, own, Width::k32));
  } else {
    ++tracer;
  }
  const auto in_each_arithmetic = [&](const auto& traverse) {
    next(traverse(0.0F));
    next(traverse(static_cast<float>(kFloatEpsilon)));
    next(traverse(0.0));
    next(traverse(kDoubleEpsilon));
  };
  in_each_arithmetic([&](auto epsilon) { return reference::grid_walk(world.grid, ray, epsilon); });
  in_each_arithmetic([&](auto epsilon) { return reference::point_steps(world.grid, ray, epsilon); });
  in_each_arithmetic([&](auto epsilon) { return reference::octree_descent(world.pyramid, ray, epsilon); });
}

// This tracer's own: its two widths.
constexpr std::size_t kOwn = 2;
// float and double, without and with an epsilon.
constexpr std::size_t kArithmetics = 4;

HardCaseRow all_cases(const std::vector<HardCaseRow>& cases) {
  HardCaseRow all;
  all.name = "all";
  for (const HardCaseRow& row : cases) {
    all.rays += row.rays;
    all.hits += row.hits;
    for (std::size_t i = 0; i < kTracers; ++i) {
      all.wrong[i] += row.wrong[i];
      all.wrong_face[i] += row.wrong_face[i];
    }
  }
  return all;
}

std::string four_digits(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

// The names that all rows have, with nothing in them.
JsonRow empty_object(const char* row) {
  JsonRow object;
  object["row"] = row;
  put_nulls(&object, {"case", "level", "tracer", "traversal", "arithmetic", "epsilon_voxels", "rays", "hits",
                      "wrong", "wrong_face", "operation", "bound_name", "unit", "error", "bound", "cases"});
  return object;
}

void add_case(const HardCaseRow& row, JsonRow* rows) {
  for (std::size_t i = 0; i < kTracers; ++i) {
    const TracerName& tracer = kTracerNames[i];
    JsonRow object = empty_object("rays");
    put_all(&object, "case", row.name, "level", row.level == 0 ? JsonRow(nullptr) : JsonRow(row.level),
            "tracer", tracer.key, "traversal", tracer.traversal, "arithmetic", tracer.arithmetic,
            "epsilon_voxels", tracer.epsilon, "rays", row.rays, "hits", row.hits, "wrong", row.wrong[i],
            "wrong_face", row.wrong_face[i]);
    rows->push_back(object);
  }
}

std::string of_rays(std::uint64_t part, std::uint64_t rays) {
  return fixed(rays == 0 ? 0.0 : 100 * static_cast<double>(part) / static_cast<double>(rays), 3);
}

std::string totals_table(const HardCaseRow& all) {
  const auto cells = [&](const TracerName& tracer) {
    const auto i = static_cast<std::size_t>(&tracer - kTracerNames.data());
    const std::uint64_t wrong = all.wrong[i];
    const std::uint64_t wrong_face = all.wrong_face[i];
    return cells_of(tracer.traversal, tracer.arithmetic,
                    tracer.epsilon != 0 ? four_digits(tracer.epsilon) : "-", grouped(wrong),
                    of_rays(wrong, all.rays), grouped(wrong_face), of_rays(wrong_face, all.rays));
  };
  return grouped(all.rays) + " near-degenerate rays, " + grouped(all.hits) +
         " of which hit, judged by exact arithmetic (epsilon in voxels;\nwrong: another voxel, a miss or a "
         "hit "
         "too many; wrong face: the right voxel by another face)\n" +
         table_of({"traversal", "arithmetic", "epsilon", "wrong", "%", "wrong face", "%"}, 2, kTracerNames,
                  cells);
}

// One traversal of textbooks at a time, the columns of four arithmetics.
std::string cases_table(const std::vector<HardCaseRow>& cases, std::size_t first) {
  std::vector<Cells> rows{{std::string("rays wrong: ") + kTracerNames[first].traversal, "rays", "thimble"}};
  for (std::size_t i = first; i < first + kArithmetics; ++i) {
    const TracerName& tracer = kTracerNames[i];
    rows.front().push_back(std::string(tracer.arithmetic) + (tracer.epsilon != 0 ? ", epsilon" : ""));
  }
  for (const HardCaseRow& row : cases) {
    Cells cells{row.name, grouped(row.rays), grouped(row.wrong[0] + row.wrong[1])};
    for (std::size_t i = first; i < first + kArithmetics; ++i) {
      cells.push_back(grouped(row.wrong[i]));
    }
    rows.push_back(cells);
  }
  return "\n" + columns_of(rows, 1);
}

std::string operations_table(const std::vector<OperationError>& operations) {
  const auto cells = [](const OperationError& found) {
    return cells_of(found.operation, found.bound_name, found.unit, four_digits(found.error),
                    four_digits(found.bound));
  };
  return "\nthe largest error of each fixed-point operation against exact arithmetic, and what its "
         "header\nallows\n" +
         table_of({"operation", "bound", "unit", "largest", "allowed"}, 3, operations, cells);
}

}  // namespace

std::vector<HardCaseRow> run_hard_cases(std::uint64_t rays, std::uint64_t seed, const Progress& progress) {
  const CaseWorld small(kSmall, 12, seed);
  const CaseWorld large(kLarge, 200, seed + 1);
  std::vector<HardCaseRow> rows;
  const std::size_t count = std::size(kCases);
  const std::uint64_t rays_a_case = std::max<std::uint64_t>((rays + count - 1) / count, 1);
  for (std::size_t i = 0; i < count; ++i) {
    const HardCase& hard = kCases[i];
    const CaseWorld& world = hard.level == kSmall ? small : large;
    Draw draw(seed * 1000003 + i);
    HardCaseRow row;
    row.name = hard.name;
    row.level = hard.level;
    for (std::uint64_t ray = 0; ray < rays_a_case; ++ray) {
      trace_all(world, hard.make(draw, std::int64_t{1} << hard.level), &row);
      if (progress && ray % 1024 == 0) {
        progress((static_cast<double>(i) + static_cast<double>(ray) / static_cast<double>(rays_a_case)) /
                 static_cast<double>(count));
      }
    }
    rows.push_back(row);
  }
  return rows;
}

JsonRow hard_case_objects(const HardCaseStudy& study) {
  JsonRow rows = JsonRow::array();
  for (const HardCaseRow& row : study.cases) {
    add_case(row, &rows);
  }
  add_case(all_cases(study.cases), &rows);
  for (const OperationError& found : study.operations) {
    JsonRow object = empty_object("operation");
    put_all(&object, "operation", found.operation, "bound_name", found.bound_name, "unit", found.unit,
            "error", found.error, "bound", found.bound, "cases", found.cases);
    rows.push_back(object);
  }
  return rows;
}

std::string hard_case_tables(const HardCaseStudy& study) {
  std::string text = totals_table(all_cases(study.cases));
  for (std::size_t first = kOwn; first < kTracers; first += kArithmetics) {
    text += cases_table(study.cases, first);
  }
  return text + operations_table(study.operations);
}

std::string hard_case_fault(const HardCaseStudy& study) {
  const HardCaseRow all = all_cases(study.cases);
  for (std::size_t i = 0; i < kOwn; ++i) {
    if (const std::uint64_t wrong = all.wrong[i] + all.wrong_face[i]; wrong != 0) {
      return grouped(wrong) + " of " + grouped(all.rays) + " rays go wrong in " + kTracerNames[i].arithmetic;
    }
  }
  for (const OperationError& found : study.operations) {
    if (!(found.error <= found.bound)) {
      return found.operation + " is off by " + four_digits(found.error) + ", " + found.bound_name +
             " allows " + four_digits(found.bound);
    }
  }
  return {};
}

}  // namespace thimble::tools
