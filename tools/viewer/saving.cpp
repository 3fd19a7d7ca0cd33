#include "viewer/saving.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "output/image.h"
#include "output/output_file.h"
#include "output/units.h"

namespace thimble::tools::viewer {
namespace {

constexpr int kMostNames = 9999;
constexpr std::size_t kLongestStem = 200;  // a name has 255 bytes on most file systems

// models/castle.vox.gz -> castle
std::string stem_of(const std::string& scene) {
  std::string name = std::filesystem::path(scene).filename().string();
  if (name.ends_with(".gz")) {
    name.resize(name.size() - 3);
  }
  const std::size_t dot = name.find_last_of('.');
  if (dot != std::string::npos && dot != 0) {
    name.resize(dot);
  }
  std::string stem;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    stem += byte >= 0x80 || std::isalnum(byte) != 0 || c == '_' || c == '.' ? c : '-';
  }
  stem.resize(std::min(stem.size(), kLongestStem));
  while (!stem.empty() && (stem.front() == '-' || stem.front() == '.')) {
    stem.erase(0, 1);  // neither an option nor hidden
  }
  return stem.empty() ? "picture" : stem;
}

std::string numbered(const std::string& stem, int number) {
  return stem + (number == 1 ? "" : "-" + std::to_string(number)) + ".png";
}

}  // namespace

std::string quoted_for_shell(std::string_view word) {
  constexpr std::string_view kPlain = "_-.,:/=+@%";
  bool plain = !word.empty();
  for (const char c : word) {
    const auto byte = static_cast<unsigned char>(c);
    plain = plain && byte < 0x80 && (std::isalnum(byte) != 0 || kPlain.find(c) != std::string_view::npos);
  }
  if (plain) {
    return std::string(word);
  }
  std::string quoted = "'";
  for (const char c : word) {
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  }
  return quoted + "'";
}

std::string render_command(const SceneArguments& scene, const ViewWishes& view,
                           const std::vector<std::string>& look, const std::string& output) {
  const bool is_like_option = scene.scene.size() > 1 && scene.scene.starts_with("-");
  std::vector<std::string> words{"thimble", "render", (is_like_option ? "./" : "") + scene.scene};
  const auto add = [&](const std::string& name, const std::string& value, bool is_given = true) {
    if (is_given) {
      words.insert(words.end(), {name, value});
    }
  };
  add("--depth", std::to_string(scene.depth.value_or(0)), scene.depth.has_value());
  for (const auto& [is_set, name] : {std::pair{scene.as_voxels, "--as-voxels"},
                                     {scene.as_points, "--as-points"},
                                     {scene.as_heights, "--as-heights"},
                                     {scene.z_up, "--z-up"}}) {
    if (is_set) {
      words.emplace_back(name);
    }
  }
  add("--colors", std::to_string(scene.full_color), scene.full_color != 0);
  add("--fit", shortest(scene.fit_percent.value_or(0)), scene.fit_percent.has_value());
  if (const auto& box = scene.clip) {
    add("--clip",
        text_of({(*box)[0], (*box)[1], (*box)[2]}) + "," + text_of({(*box)[3], (*box)[4], (*box)[5]}));
  }
  add("--frame", std::to_string(scene.frame.value_or(0)), scene.frame.has_value());
  add("--size", std::to_string(view.width_px) + "x" + std::to_string(view.height_px));
  add("--projection", "orthographic", view.orthographic);
  if (!view.eye) {
    static constexpr std::array kSides{"paper", "best", "iso", "front", "back", "left", "right", "top"};
    add("--view", kSides[static_cast<std::size_t>(view.side)], view.side != NamedView::kBest);
    add("--turn", shortest(view.onward.turn), view.onward.turn != 0);
    add("--tilt", shortest(view.onward.tilt), view.onward.tilt != 0);
  }
  for (const auto& [name, point] :
       {std::pair{"--eye", view.eye}, {"--target", view.target}, {"--up", view.up}}) {
    if (point) {
      add(name, text_of(*point));
    }
  }
  add("--fov", shortest(view.fov_degrees), view.placed && !view.orthographic);
  add("--span", shortest(view.span.value_or(0)), view.span.has_value());
  add("--direction-bits", std::to_string(view.direction_bits), view.direction_bits != 0);
  words.insert(words.end(), look.begin(), look.end());
  add("-o", output);
  std::string line;
  for (const std::string& word : words) {
    line += (line.empty() ? "" : " ") + quoted_for_shell(word);
  }
  return line;
}

std::string free_picture_name(const std::string& scene) {
  const std::string stem = stem_of(scene);
  for (int number = 1; number <= kMostNames; ++number) {
    std::string name = numbered(stem, number);
    std::error_code error;
    if (!std::filesystem::exists(std::filesystem::symlink_status(name, error))) {
      return name;
    }
  }
  throw OutputError(numbered(stem, 1) + ": this name and 9,998 others are taken");
}

std::string save_picture(const std::string& scene, std::int32_t width_px, std::int32_t height_px,
                         const std::vector<std::uint8_t>& rgb) {
  for (;;) {
    std::string name = free_picture_name(scene);
    // The name is taken first, by a file that only this call can make.
    const int taken = ::open(name.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (taken < 0 && errno == EEXIST) {
      continue;  // somebody else just took it
    }
    if (taken < 0) {
      throw OutputError(name + ": cannot be written: " + std::strerror(errno));
    }
    ::close(taken);
    try {
      OutputFile file(name);
      write_image(&file, ImageKind::kPng, {width_px, height_px, PixelFormat::kRgb888, rgb});
      file.commit();
    } catch (...) {
      ::unlink(name.c_str());
      throw;
    }
    return name;
  }
}

}  // namespace thimble::tools::viewer
