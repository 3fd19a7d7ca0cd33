/// Pages to hand on: the template that `make web` builds (platform/web/share.html), and what it is filled in with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands/render_command.h"
#include "output/image.h"

namespace thimble::tools {

inline constexpr std::size_t kMostPosterBytes = 60000;

/// Throws OutputError where there is none.
std::string load_page();
/// What stands before its scenes, each value in its places, one after the other, and behind them. Throws OutputError where it
/// is another page.
std::pair<std::string, std::string> around_scenes(
    const std::string& page, std::initializer_list<std::pair<std::string_view, std::string>> values);

/// The address of a JPEG of that picture within so many bytes: as good as there is room for. Throws InputError.
std::string poster_url(const Image& image, std::size_t most_bytes);
/// The first column's, at the top and at the bottom, for what is behind the picture.
std::string edge_colors(const Image& image);

/// The scene as the page reads it: the bytes of `thimble bake` with that camera, whose picture is that of the scene itself,
/// compressed. With a limit blocks are merged until the bytes before that keep it, where they can.
std::vector<std::uint8_t> page_scene(const RenderCommand& command, const SceneSource& source,
                                     const SceneCamera& camera,
                                     std::optional<std::uint64_t> most_bytes = std::nullopt);
/// The element that holds it.
std::string scene_element(std::span<const std::uint8_t> packed);

}  // namespace thimble::tools
