/// @file part_options.h
/// --rows and --part: a part of a picture or of a film, for `thimble join`.
#ifndef THIMBLE_TOOLS_COMMANDS_PART_OPTIONS_H
#define THIMBLE_TOOLS_COMMANDS_PART_OPTIONS_H

#include <cstdint>
#include <optional>
#include <string>

#include "output/image.h"
#include "output/part_file.h"

namespace CLI {
class App;
}

namespace thimble::tools {

class OutputFile;
struct RenderCommand;

/// An option that is FIRST:COUNT.
void add_range(CLI::App& app, const std::string& name, std::optional<RowRange>* range,
               const std::string& help);
/// Ends the command as wrong usage where `range` reaches beyond `all` rows or frames.
void check_range(const std::string& name, const RowRange& range, std::int64_t all,
                 const std::string& of_what);

/// Ends the command as wrong usage where --output, --rows, --part, --turntable and --camera-path do not go together.
void check_output(const RenderCommand& command);

/// Whether a part of that name is drawn in one bit a pixel: its ending is .pbm.part.
bool is_mono_part(const std::string& output);

/// The part of a picture that these rows are. `image` is Rgb888, with or without alpha, or Mono1.
void write_rows(OutputFile* file, PartHeader header, const Image& image, std::int32_t height_px);

}  // namespace thimble::tools

#endif
