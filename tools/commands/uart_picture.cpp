// thimble uart-picture: the picture in what a board sent over its UART, among its other lines. `make emulate SHOT=...`
// asks for it, and it does for the log of a terminal that a real board hangs on.
#include "commands/commands.h"

namespace thimble::tools {
namespace {

// The number at `*at`, which ends at a blank or a line feed; moves behind that.
std::optional<std::int32_t> take_number(std::string_view text, std::size_t* at) {
  const std::size_t end = std::min(text.find_first_of(" \n", *at), text.size());
  const auto number = parse_whole(text.substr(*at, end - *at), 1, kMaxPicturePx);
  if (!number || end == text.size()) {
    return std::nullopt;
  }
  *at = end + 1;
  return static_cast<std::int32_t>(*number);
}

// The first whole picture, where a P5 (greys) or P6 (colours) begins a line.
Image find_picture(std::string_view text) {
  bool any = false;
  for (std::size_t mark = text.find('P'); mark != std::string_view::npos; mark = text.find('P', mark + 1)) {
    const std::string_view kind = text.substr(mark, 3);
    const bool has_colors = kind == "P6\n";
    if ((kind != "P5\n" && !has_colors) || (mark != 0 && text[mark - 1] != '\n')) {
      continue;
    }
    std::size_t at = mark + kind.size();
    const auto width = take_number(text, &at);
    const auto height = width ? take_number(text, &at) : std::nullopt;
    const auto most = height ? take_number(text, &at) : std::nullopt;
    if (!most || *most != 255) {
      continue;
    }
    any = true;
    const PixelFormat format = has_colors ? PixelFormat::kRgb888 : PixelFormat::kGray8;
    const std::size_t bytes = row_bytes(format, *width) * static_cast<std::size_t>(*height);
    if (text.size() - at >= bytes) {
      const std::string_view pixels = text.substr(at, bytes);
      return {*width, *height, format, {pixels.begin(), pixels.end()}};
    }
  }
  throw InputError(any ? "the picture in it is not whole" : "there is no picture (P5, P6) in it");
}

}  // namespace

void add_uart_picture(CLI::App& app) {
  struct Command {
    std::string log;
    std::string output;
  };
  CLI::App* sub = add_command(app, "uart-picture", "Takes a picture out of what a board sent over its UART.");
  Command* const command = options_for<Command>(*sub, [](const Command& given) {
    const SharedBytes log = load_file(given.log, std::uint64_t{1} << 30);
    const Image picture = find_picture(log.text());
    OutputSet outputs({given.output}, {given.log});
    write_picture(outputs[0], given.output, picture);
    outputs.commit();
  });
  sub->add_option("scene", command->log, "the bytes that it sent")->type_name("LOG")->required();
  add_output_option(
      *sub, "-o,--output", "FILE", &command->output,
      [](const std::string& text) { return image_kind(text).has_value(); }, kImageEndings,
      "the picture, .png, .ppm, .pgm or .pbm by its ending")
      ->required();
  sub->group("");
}

}  // namespace thimble::tools
