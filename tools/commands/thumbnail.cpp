// thimble thumbnail: a small picture for file managers, within limits that hold for any file.
#include "commands/commands.h"
#include "commands/limited_picture.h"
#include "output/file_place.h"

namespace thimble::tools {
namespace {

struct ThumbnailCommand {
  std::string scene;
  std::string output;
  std::int32_t side_px = 128;
};

void run(const ThumbnailCommand& command) {
  constexpr PictureLimits kLimits{1, std::uint64_t{256} << 20, true};
  const OutputClaim claim({command.output}, {command.scene});
  SmallPicture picture;
  LimitedPicture(command.scene, command.side_px, kLimits).take(&picture, true);
  fail_if(!picture.error.empty(), picture.error);
  OutputFile file(command.output, OutputFile::Empty::kIsFilled);
  write_image(&file, ImageKind::kPng, picture.image);
  file.commit();
}

}  // namespace

void add_thumbnail(CLI::App& app) {
  CLI::App* sub =
      add_command(app, "thumbnail",
                  "Draw a small picture of a file in at most 1 s, 256 MB and one thread, whatever "
                  "the file is, as file managers ask for it.");
  ThumbnailCommand* const command = options_for<ThumbnailCommand>(*sub, run);
  sub->add_option("scene", command->scene, "the file")->type_name("SCENE")->required();
  sub->add_option("picture", command->output, "the picture, a PNG whatever its name")
      ->type_name("FILE")
      ->required();
  add_whole_option(*sub, "--size", "N", 16, 1024, &command->side_px, "pixels a side");
}

}  // namespace thimble::tools
