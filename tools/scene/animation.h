/// Films as files: pictures one after the other as a GIF of one palette, as YUV4MPEG2, or as a picture each.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "output/image.h"
#include "output/part_file.h"

namespace thimble::tools {

class OutputFile;
class GifColors;

/// Whether `path` ends as films do: .gif or .y4m.
bool is_film(std::string_view path);
/// Whether it is one of a picture for each frame: frame_%03d.png, .jpg, .ppm ..., with one %d or %0Nd for its number.
bool is_sequence(const std::string& path);
/// The names of such pictures; of another path none.
std::vector<std::string> sequence_names(const std::string& path, std::size_t frames);
/// What these two take, for errors and help.
inline constexpr const char* kFilmEndings = ".gif, .y4m or a picture a frame, such as frame_%03d.png";

/// A turntable takes six seconds, but a frame at most one and at least 1/50; along a path pass 25 frames a second; an
/// animation plays 10, as in the viewer, since no file says its speed.
struct FilmTimes {
  FilmTimes(PartKind kind, int count);
  int frames;  ///< in so many seconds
  int seconds;
  /// Of a second a frame, in a GIF.
  int hundredths() const { return 100 * seconds / frames; }
};

/// A film's bytes, frame by frame. They depend on the frames and on nothing else.
class Film {
 public:
  /// Gives the frame of that number. Pictures are Rgb888 and of one size.
  using Frame = std::function<Image(std::size_t number)>;

  /// Writes what stands in front of `frames` frames. The palette of a .gif comes from a few of them all over the
  /// film, which are drawn here already; a frame of other colours gets one of its own. Of a sequence `file` is null:
  /// each picture is there as soon as it is added.
  Film(OutputFile* file, const std::string& path, PartKind kind, std::size_t frames, const Frame& frame);
  ~Film();
  void add(const Image& image);
  /// Writes what stands behind the last one. Committing is the caller's.
  void end();

 private:
  OutputFile* file_;
  std::string path_;
  FilmTimes times_;
  std::size_t added_ = 0;
  std::unique_ptr<GifColors> colors_;  // of a GIF
};

}  // namespace thimble::tools
