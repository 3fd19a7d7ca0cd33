#include "scene/edge_rows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <utility>

#include "scene/workers.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kSegmentPx = kEdgeSegmentPx;

// Calls run(task, worker) for each task; the worst status.
template <class Run>
Status for_tasks(std::int32_t tasks, int threads, const Run& run) {
  std::atomic<Status> worst{Status::kOk};
  each_task(static_cast<std::size_t>(tasks), threads, [&](std::size_t task, std::size_t worker) {
    const Status status =
        worst.load() == Status::kOk ? run(static_cast<std::int32_t>(task), worker) : Status::kOk;
    if (status != Status::kOk) {
      worst.store(status);
    }
  });
  return worst;
}

}  // namespace

std::int32_t EdgeRows::rows_within(std::size_t bytes, int channels, std::int32_t width_px, int threads,
                                   std::size_t more) {
  const std::size_t none = work_bytes(channels, width_px, 0, threads);
  const std::size_t each = work_bytes(channels, width_px, 1, threads) - none + more;
  return bytes < none || each == 0 ? 0
                                   : static_cast<std::int32_t>(std::min<std::size_t>(
                                         (bytes - none) / each, std::size_t{kMaxPicturePx}));
}

EdgeRows::EdgeRows(const Camera& camera, const Camera& fine, int channels, int threads, EdgeRowsHooks hooks)
    : camera_(camera),
      fine_(fine),
      channels_(static_cast<std::size_t>(channels)),
      threads_(threads),
      hooks_(std::move(hooks)),
      line_(channels_ * static_cast<std::size_t>(camera.width_px())) {}

Status EdgeRows::draw(std::int32_t first_row, std::int32_t rows, Bytes work) {
  const std::int32_t first = std::max(0, first_row - 1);
  const std::int32_t end = std::min(camera_.height_px(), first_row + rows + 1);
  const auto width = static_cast<std::size_t>(camera_.width_px());
  const Bytes centres = work.subspan(0, line_ * static_cast<std::size_t>(rows + 2));
  const Bytes samples = work.subspan(centres.size, width * static_cast<std::size_t>(threads_));
  Status status = draw_centres(first, end, centres);
  if (status != Status::kOk) {
    return status;
  }
  return for_tasks(rows, threads_, [&](std::int32_t row, std::size_t worker) {
    return draw_row(first_row + row, centres, samples.subspan(width * worker, width), worker);
  });
}

// The rows of one sample a pixel that are wanted; those that are there already move to the front.
Status EdgeRows::draw_centres(std::int32_t first, std::int32_t end, Bytes centres) {
  const auto at = [&](std::int32_t row) { return line_ * static_cast<std::size_t>(row - first); };
  std::int32_t missing = first;
  if (kept_first_ <= first && first < kept_end_) {
    missing = std::min(kept_end_, end);
    std::memmove(centres.data, centres.data + line_ * static_cast<std::size_t>(first - kept_first_),
                 at(missing));
  }
  kept_first_ = first;
  kept_end_ = first;
  const Status status = for_tasks(end - missing, threads_, [&](std::int32_t i, std::size_t worker) {
    const std::int32_t y = missing + i;
    return hooks_.draw({camera_, y, 0, y, camera_.width_px(), false}, centres.subspan(at(y), line_), worker);
  });
  if (status == Status::kOk) {
    kept_end_ = end;
  }
  return status;
}

Status EdgeRows::draw_row(std::int32_t y, ConstBytes centres, Bytes samples, std::size_t worker) const {
  const auto row = [&](std::int32_t at) {
    return at < kept_first_ || at >= kept_end_
               ? ConstBytes()
               : centres.subspan(line_ * static_cast<std::size_t>(at - kept_first_), line_);
  };
  const std::int32_t width = camera_.width_px();
  Status status = edge_strengths(row(y - 1), row(y), row(y + 1), static_cast<int>(channels_), width, samples);
  if (status == Status::kOk) {
    status = place_edge_samples(samples, width, samples);
  }
  for (std::int32_t x = 0; x < width && status == Status::kOk; x += kEdgeSegmentPx) {
    status = draw_segment(y, x, std::min(kEdgeSegmentPx, width - x), row(y), samples, worker);
  }
  return status;
}

Status EdgeRows::draw_segment(std::int32_t y, std::int32_t first, std::int32_t count, ConstBytes row,
                              ConstBytes samples, std::size_t worker) const {
  std::array<std::uint32_t, kSegmentPx * kMostChannels> sums;
  std::array<std::uint8_t, kSegmentPx * kMostChannels> drawn;
  const std::size_t bytes = channels_ * static_cast<std::size_t>(count);
  std::copy_n(row.data + channels_ * static_cast<std::size_t>(first), bytes, sums.begin());
  const std::uint8_t* wanted = samples.data + first;
  for (int index = 0; index < kMostEdgeSamples; ++index) {
    for (std::int32_t x = 0; x < count;) {
      if (wanted[x] <= index) {
        ++x;
        continue;
      }
      std::int32_t end = x + 1;
      while (end < count && wanted[end] > index) {
        ++end;
      }
      const Camera camera = edge_sample_row(fine_, first + x, y, end - x, index);
      const std::size_t begin = channels_ * static_cast<std::size_t>(x);
      const std::size_t size = channels_ * static_cast<std::size_t>(end - x);
      const Status status =
          hooks_.draw({camera, 0, first + x, y, end - x, true}, Bytes(drawn.data(), size), worker);
      if (status != Status::kOk) {
        return status;
      }
      for (std::size_t i = 0; i < size; ++i) {
        sums[begin + i] += drawn[i];
      }
      x = end;
    }
  }
  for (std::int32_t x = 0; x < count; ++x) {
    hooks_.finish(first + x, y, sums.data() + channels_ * static_cast<std::size_t>(x), 1U + wanted[x]);
  }
  return Status::kOk;
}

}  // namespace thimble::tools
