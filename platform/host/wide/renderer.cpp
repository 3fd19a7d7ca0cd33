#include "host/wide/renderer.h"

#include <string.h>

namespace thimble::wide {
namespace {

int32_t words_of(int32_t width_px) {
  return (width_px + 63) / 64;
}

bool all_covered(const Depths& depths, const Rectangle& where) {
  const int32_t first = where.x0 >> 6;
  const int32_t last = (where.x1 - 1) >> 6;
  const uint64_t head = ~uint64_t{0} << (where.x0 & 63);
  const uint64_t tail = ~uint64_t{0} >> (63 - ((where.x1 - 1) & 63));
  for (int32_t y = where.y0; y < where.y1; ++y) {
    const uint64_t* row = depths.covered + static_cast<size_t>(y) * static_cast<size_t>(depths.words);
    for (int32_t word = first; word <= last; ++word) {
      uint64_t wanted = ~uint64_t{0};
      wanted &= word == first ? head : wanted;
      wanted &= word == last ? tail : wanted;
      if ((row[word] & wanted) != wanted) {
        return false;
      }
    }
  }
  return true;
}

// Children that lie nearer to the eye in every axis come first: their numbers, exclusive-or'ed with this,
// ascend.
unsigned first_octant(const Camera& camera, const uint32_t (&corner)[3], int level) {
  unsigned first = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t middle = (int64_t{corner[axis]} + (int64_t{1} << (level - 1))) * 256;
    const bool upper_first =
        camera.is_perspective() ? camera.eye()[axis].raw >= middle : camera.direction()[axis] < 0;
    first |= upper_first ? 1U << axis : 0U;
  }
  return first;
}

struct Block {
  uint32_t node;
  int level;
  uint32_t corner[3];
  Rectangle where;
};

void draw_block(const VoxelLists& lists, const Frame& frame, const Block& block, const Depths& depths,
                Counts* counts) {
  const BlockNode& node = lists.nodes()[block.node];
  Run run;
  run.entries = lists.entries().data + node.first_entry;
  run.count = node.entries;
  run.first = node.first_entry;
  run.unit = !lists.has_blocks();
  const uint32_t cube = (uint32_t{1} << kCubeLevel) - 1;
  if (block.level <= kCubeLevel) {
    for (int axis = 0; axis < 3; ++axis) {
      run.corner[axis] = block.corner[axis] & ~cube;
    }
    draw_run(frame, run, depths, counts);
    return;
  }
  // A solid block of several cubes, an entry each, in Morton order.
  run.count = 1;
  for (uint32_t piece = 0; piece < node.entries; ++piece) {
    for (unsigned axis = 0; axis < 3; ++axis) {
      const uint32_t place = (piece >> axis & 1U) | (piece >> (3 + axis) & 1U) << 1;
      run.corner[axis] = block.corner[axis] + (place << kCubeLevel);
    }
    draw_run(frame, run, depths, counts);
    ++run.entries;
    ++run.first;
  }
}

void draw_blocks(const VoxelLists& lists, const Camera& camera, const Frame& frame, uint32_t block_boxes,
                 const Depths& depths, Counts* counts) {
  const CompactTree& tree = lists.tree();
  if (tree.empty()) {
    return;
  }
  Block stack[7 * kMaxLevel + 8];
  int depth = 0;
  stack[depth++] = {0, tree.level(), {0, 0, 0}, {frame.tile.x0, frame.tile.y0, frame.tile.x1, frame.tile.y1}};
  while (depth > 0) {
    const Block block = stack[--depth];
    ++counts->nodes;
    if (all_covered(depths, block.where)) {
      continue;
    }
    const BlockNode& node = lists.nodes()[block.node];
    const unsigned mask = tree.mask(block.node);
    const bool small = node.entries <= block_boxes && block.level <= kCubeLevel;
    if (mask == 0 || block.level <= lists.block_level() || small) {
      draw_block(lists, frame, block, depths, counts);
      continue;
    }
    const uint32_t side = uint32_t{1} << (block.level - 1);
    float x[8];
    float y[8];
    float z[8];
    for (unsigned octant = 0; octant < 8; ++octant) {
      x[octant] = static_cast<float>(block.corner[0] + ((octant & 1U) != 0 ? side : 0));
      y[octant] = static_cast<float>(block.corner[1] + ((octant & 2U) != 0 ? side : 0));
      z[octant] = static_cast<float>(block.corner[2] + ((octant & 4U) != 0 ? side : 0));
    }
    Rectangle where[8];
    find_rectangles(frame, x, y, z, static_cast<float>(side), where);
    const unsigned first = first_octant(camera, block.corner, block.level);
    for (unsigned turn = 8; turn-- > 0;) {  // the last pushed is the first drawn
      const unsigned octant = turn ^ first;
      if ((mask >> octant & 1U) == 0 || where[octant].x0 >= where[octant].x1) {
        continue;
      }
      const uint32_t number = static_cast<uint32_t>(__builtin_popcount(mask & ((1U << octant) - 1)));
      stack[depth++] = {node.first_child + number,
                        block.level - 1,
                        {block.corner[0] + ((octant & 1U) != 0 ? side : 0),
                         block.corner[1] + ((octant & 2U) != 0 ? side : 0),
                         block.corner[2] + ((octant & 4U) != 0 ? side : 0)},
                        where[octant]};
    }
  }
}

// Turns the nearest boxes of some rows into pixels.
class Painter {
 public:
  Painter(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band,
          size_t stride, const Frame& frame, const Depths& depths)
      : lists_(lists),
        camera_(camera),
        shading_(shading),
        band_(band),
        stride_(stride),
        frame_(frame),
        depths_(depths) {
    background_ = shade(Hit{}, Ray{}, camera, shading);
  }

  uint64_t paint_row(int32_t row) const {
    const int32_t y = band_.first_row + row;
    uint8_t* line = band_.pixels.data + stride_ * static_cast<size_t>(row);
    const int32_t width = camera_.width_px();
    memset(line, 0, row_bytes(band_.format, width));
    uint64_t hits = 0;
    for (int32_t word = 0; word < depths_.words; ++word) {
      const uint64_t covered = depths_.covered[static_cast<size_t>(y) * static_cast<size_t>(depths_.words) +
                                               static_cast<size_t>(word)];
      const int32_t first = word * 64;
      const int32_t pixels = width - first < 64 ? width - first : 64;
      Rgb8 colors[64];
      for (Rgb8& color : colors) {
        color = background_;
      }
      if (covered != 0) {
        hits += static_cast<unsigned>(__builtin_popcountll(covered));
        color_word(y, word, covered, colors);
      }
      store(line, first, pixels, y, colors);
    }
    return hits;
  }

 private:
  void color_word(int32_t y, int32_t word, uint64_t covered, Rgb8* colors) const {
    const uint64_t* nearest = depths_.nearest +
                              static_cast<size_t>(y) * static_cast<size_t>(depths_.width_px) +
                              static_cast<size_t>(word) * 64;
    int32_t levels[64] = {};
    const uint32_t number_mask = (uint32_t{1} << kEntryBits) - 1;
    if (lists_.has_blocks()) {
      for (uint64_t left = covered; left != 0; left &= left - 1) {
        const int i = __builtin_ctzll(left);
        const uint32_t entry = lists_.entries()[static_cast<uint32_t>(nearest[i]) & number_mask];
        levels[i] = static_cast<int32_t>((entry >> 30) < 3 ? entry >> 30 : 3 + (entry & 7U));
      }
    }
    WordHits hits;
    resolve_word(frame_, y, word, nearest, lists_.has_blocks() ? levels : nullptr, &hits);
    for (uint64_t left = covered; left != 0; left &= left - 1) {
      const int i = __builtin_ctzll(left);
      Hit hit;
      hit.kind = HitKind::kHit;
      hit.axis = static_cast<int8_t>(hits.axis[i]);
      hit.t_numerator = hits.numerator[i];
      const Vec3i direction{hits.direction[0][i], hits.direction[1][i], hits.direction[2][i]};
      if (hit.axis >= 0) {
        const int32_t speed = direction[hit.axis];
        hit.t_denominator = 256 * (speed < 0 ? -speed : speed);
      }
      hit.material = lists_.materials().empty()
                         ? lists_.tree().uniform_material()
                         : lists_.materials()[static_cast<uint32_t>(nearest[i]) & number_mask];
      colors[i] = shade(hit, Ray{{}, direction}, camera_, shading_);
    }
  }

  void store(uint8_t* line, int32_t first, int32_t pixels, int32_t y, const Rgb8* colors) const {
    for (int32_t i = 0; i < pixels; ++i) {
      store_pixel(line, first + i, y, band_.format, colors[i]);
    }
  }

  const VoxelLists& lists_;
  const Camera& camera_;
  const Shading& shading_;
  const Band& band_;
  size_t stride_;
  const Frame& frame_;
  const Depths& depths_;
  Rgb8 background_;
};

}  // namespace

size_t workspace_bytes(int32_t width_px, int32_t height_px) {
  const size_t width = static_cast<size_t>(words_of(width_px)) * 64;
  const size_t height = static_cast<size_t>(height_px);
  return (width * height) * sizeof(uint64_t) + width / 64 * height * sizeof(uint64_t) +
         64 * sizeof(uint64_t) + 64;
}

Status render(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band,
              Bytes workspace, RenderCounts* counts, const Options& options, Stats* stats) {
  const int32_t width = camera.width_px();
  if (width == 0 || camera.level() != lists.tree().level() || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  const size_t stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  if (line_bytes > band.pixels.size ||
      static_cast<size_t>(band.rows - 1) > (band.pixels.size - line_bytes) / stride ||
      workspace.size < workspace_bytes(width, camera.height_px())) {
    return Status::kOutOfMemory;
  }
  if (lists.entries().size > size_t{1} << kEntryBits) {
    return Status::kTooFine;
  }
  Arena arena(workspace);
  Depths depths;
  depths.words = words_of(width);
  depths.width_px = depths.words * 64;
  const size_t words = static_cast<size_t>(depths.words) * static_cast<size_t>(camera.height_px());
  depths.covered = reinterpret_cast<uint64_t*>(arena.take(words * sizeof(uint64_t)).data);
  depths.nearest = reinterpret_cast<uint64_t*>(arena.take(words * 64 * sizeof(uint64_t)).data);
  memset(depths.covered, 0, words * sizeof(uint64_t));

  Frame frame;
  if (!make_frame(camera, {0, band.first_row, width, band.first_row + band.rows}, &frame)) {
    return Status::kTooFine;
  }
  Stats done;
  done.block_boxes = options.block_boxes == 0 ? 256 : options.block_boxes;
  draw_blocks(lists, camera, frame, done.block_boxes, depths, &done.counts);
  const Painter painter(lists, camera, shading, band, stride, frame, depths);
  uint64_t hits = 0;
  for (int32_t row = 0; row < band.rows; ++row) {
    hits += painter.paint_row(row);
  }
  if (counts != nullptr) {
    counts->rays += static_cast<uint64_t>(width) * static_cast<uint64_t>(band.rows);
    counts->hits += hits;
    counts->node_visits += done.counts.candidates;
  }
  if (stats != nullptr) {
    *stats = done;
  }
  return Status::kOk;
}

}  // namespace thimble::wide
