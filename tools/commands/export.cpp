// thimble export: the voxels of a scene for other programs.
#include "commands/commands.h"
#include "output/voxel_file.h"

namespace thimble::tools {
namespace {

struct ExportCommand {
  SceneOptions scene;
  std::string output;
  VoxelFormat format = VoxelFormat::kVox;
};

void run(const ExportCommand& command) {
  OutputSet outputs({command.output}, {command.scene.arguments.scene});
  const auto source = command.scene.open();
  const BuiltScene built = command.scene.build(*source);
  fail_if(built.voxels() == 0, "nothing is solid");
  with_progress("writing", command.scene.quiet, [&](const Progress& progress) {
    write_voxels(outputs[0], command.format, built.compact(), source->palette(), source->has_colors(),
                 progress);
  });
  outputs.commit();
  if (!command.scene.quiet) {
    const VoxelBox box = built.bounds();
    std::fprintf(stderr, "%s, from %d,%d,%d to %d,%d,%d\n", counted(built.voxels(), "voxel").c_str(),
                 box.low.x, box.low.y, box.low.z, box.high.x - 1, box.high.y - 1, box.high.z - 1);
    const Vec3i moved{box.low.x & ~255, box.low.y & ~255, box.low.z & ~255};
    if (command.format == VoxelFormat::kVox && (moved.x | moved.y | moved.z) != 0) {
      std::fprintf(stderr,
                   "note: who reads this .vox puts its lowest model to 0, which moves all by %d,%d,%d\n",
                   -moved.x, -moved.y, -moved.z);
    }
  }
}

}  // namespace

void add_export(CLI::App& app) {
  CLI::App* sub =
      add_command(app, "export", "Write the voxels of a scene, with their colours, for other programs.");
  ExportCommand* const command = options_for<ExportCommand>(*sub, run);
  command->scene.add_scene(*sub);
  add_text_option(
      *sub, "-o,--output", "FILE",
      [command](const std::string& text) -> std::string {
        const auto format = voxel_format(text);
        command->output = text;
        command->format = format.value_or(command->format);
        return format ? "" : "does not end in .vox, .npy, .ply or .csv";
      },
      "every solid voxel at its place: .vox (MagicaVoxel), .npy (bytes, X x Y x Z x 4: red, green, blue and "
      "255, or 0 where nothing is; X x Y x Z without colours), .ply (points) or .csv (x,y,z,r,g,b), whose "
      "coordinates are voxel indices: --as-voxels reads those two as such. Lights, cameras and what is "
      "glass, metal or glows are left out")
      ->required();
  add_flag(*sub, "--quiet", &command->scene.quiet, "no progress bar and no summary on standard error");
}

}  // namespace thimble::tools
