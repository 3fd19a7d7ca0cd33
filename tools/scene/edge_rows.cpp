#include "scene/edge_rows.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "scene/workers.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kSegmentPx = kEdgeSegmentPx;

// Pixels whose samples are drawn together, about: enough for all threads, few enough to lie in a cache.
constexpr std::int32_t kTogetherPx = 16384;

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
  if (hooks_.draw_places) {
    return draw_together(first_row, rows, centres);
  }
  return each_until_error(rows, threads_, [&](std::int32_t row, std::size_t worker) {
    const std::int32_t y = first_row + row;
    const Bytes wanted = samples.subspan(width * worker, width);
    Status drawn = find_wanted(y, centres, wanted);
    for (std::int32_t x = 0; x < camera_.width_px() && drawn == Status::kOk; x += kEdgeSegmentPx) {
      drawn = draw_segment(y, x, std::min(kEdgeSegmentPx, camera_.width_px() - x), centre_row(y, centres),
                           wanted, worker);
    }
    return drawn;
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
  const auto draw_one = [&](std::int32_t i, std::size_t worker) {
    const std::int32_t y = missing + i;
    return hooks_.draw({camera_, y, 0, y, camera_.width_px(), false}, centres.subspan(at(y), line_), worker);
  };
  const Status status = hooks_.draw_places ? draw_all_centres(missing, end, centres.subspan(at(missing)))
                                           : each_until_error(end - missing, threads_, draw_one);
  if (status == Status::kOk) {
    kept_end_ = end;
  }
  return status;
}

Status EdgeRows::draw_all_centres(std::int32_t first, std::int32_t end, Bytes centres) {
  const std::int32_t width = camera_.width_px();
  const std::int32_t at_once = std::max(1, kTogetherPx / width);
  Status status = Status::kOk;
  for (std::int32_t row = first; row < end && status == Status::kOk; row += at_once) {
    places_.clear();
    for (std::int32_t y = row; y < std::min(end, row + at_once); ++y) {
      for (std::int32_t x = 0; x < width; ++x) {
        places_.push_back({x, y, x, y});
      }
    }
    status = hooks_.draw_places(camera_, {places_.data(), places_.size()},
                                centres.subspan(line_ * static_cast<std::size_t>(row - first)));
  }
  return status;
}

// The samples of the rows in `wanted_`, in the order in which they are added up.
void EdgeRows::list_places(std::int32_t first_row, std::int32_t rows) {
  const std::int32_t width = camera_.width_px();
  const std::uint8_t* wanted = wanted_.data();
  places_.clear();
  row_places_.clear();
  for (std::int32_t y = first_row; y < first_row + rows; ++y) {
    row_places_.push_back(places_.size());
    for (std::int32_t x = 0; x < width; ++x, ++wanted) {
      for (int index = 0; index < *wanted; ++index) {
        const EdgeSamplePlace place = edge_sample_place(index);
        places_.push_back({x * kEdgeGrid + place.x, y * kEdgeGrid + place.y, x, y});
      }
    }
  }
}

void EdgeRows::finish_row(std::int32_t y, const std::uint8_t* wanted, ConstBytes row,
                          const std::uint8_t* drawn) const {
  std::array<std::uint32_t, kMostChannels> sums{};
  const std::uint8_t* centre = row.data;
  for (std::int32_t x = 0; x < camera_.width_px(); ++x, centre += channels_) {
    std::copy_n(centre, channels_, sums.begin());
    for (int index = 0; index < wanted[x]; ++index, drawn += channels_) {
      for (std::size_t channel = 0; channel < channels_; ++channel) {
        sums[channel] += drawn[channel];
      }
    }
    hooks_.finish(x, y, sums.data(), 1U + wanted[x]);
  }
}

Status EdgeRows::draw_together(std::int32_t first_row, std::int32_t rows, ConstBytes centres) {
  const auto width = static_cast<std::size_t>(camera_.width_px());
  const std::int32_t most = std::max(1, kTogetherPx / camera_.width_px());
  Status status = Status::kOk;
  for (std::int32_t done = 0; done < rows && status == Status::kOk; done += most) {
    const std::int32_t first = first_row + done;
    const std::int32_t count = std::min(most, rows - done);
    wanted_.resize(width * static_cast<std::size_t>(count));
    const auto row_of = [&](std::int32_t row) {
      return wanted_.data() + width * static_cast<std::size_t>(row);
    };
    status = each_until_error(count, threads_, [&](std::int32_t row, std::size_t /*worker*/) {
      return find_wanted(first + row, centres, Bytes(row_of(row), width));
    });
    if (status != Status::kOk) {
      return status;
    }
    list_places(first, count);
    drawn_.resize(channels_ * places_.size());
    status = hooks_.draw_places(fine_, {places_.data(), places_.size()}, Bytes(drawn_.data(), drawn_.size()));
    if (status != Status::kOk) {
      return status;
    }
    status = each_until_error(count, threads_, [&](std::int32_t row, std::size_t /*worker*/) {
      finish_row(first + row, row_of(row), centre_row(first + row, centres),
                 drawn_.data() + channels_ * row_places_[static_cast<std::size_t>(row)]);
      return Status::kOk;
    });
  }
  return status;
}

ConstBytes EdgeRows::centre_row(std::int32_t y, ConstBytes centres) const {
  return y < kept_first_ || y >= kept_end_
             ? ConstBytes()
             : centres.subspan(line_ * static_cast<std::size_t>(y - kept_first_), line_);
}

// How many samples each pixel of a row gets beside its one.
Status EdgeRows::find_wanted(std::int32_t y, ConstBytes centres, Bytes samples) const {
  const std::int32_t width = camera_.width_px();
  const Status status =
      edge_strengths(centre_row(y - 1, centres), centre_row(y, centres), centre_row(y + 1, centres),
                     static_cast<int>(channels_), width, samples);
  return status != Status::kOk ? status : place_edge_samples(samples, width, samples);
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
