// thimble info: what a scene is, and what it takes.
#include "commands/commands.h"
#include "scene/board_fit.h"

namespace thimble::tools {
namespace {

std::string describe(const SceneCamera& camera) {
  std::string text =
      camera.is_perspective
          ? "perspective, fov " + shortest(static_cast<double>(camera.fov_degrees.raw) / Q16::kOne) +
                " degrees"
          : "orthographic, span " + shortest(static_cast<double>(camera.span.raw) / Q14::kOne) + " voxels";
  text += ", eye " + text_of(real_of(camera.eye)) + ", target " + text_of(real_of(camera.target));
  if (camera.up != Vec3i{}) {
    constexpr double kUnit = kMaxViewComponent;
    text += ", up " + text_of({camera.up.x / kUnit, camera.up.y / kUnit, camera.up.z / kUnit});
  }
  if (camera.direction_bits != 0) {
    text += concat(", directions of ", camera.direction_bits, " bits");
  }
  return text;
}

// Lights and the rest, where there are any, and what they and the materials call for.
template <class Row>
void describe(const LitDescription& lit, const UsedMaterials& used, const Row& row) {
  const LitScene& rest = lit.rest;
  if (!lit.lights.empty()) {
    const auto points = std::count_if(lit.lights.begin(), lit.lights.end(),
                                      [](const Light& light) { return light.is_point; });
    row("lights", concat(lit.lights.size(), ": ", lit.lights.size() - static_cast<std::size_t>(points),
                         " distant, ", points, " in the world"));
  }
  if (rest.has_water) {
    const WaterSurface& water = rest.water;
    const double level = water.corner.z + static_cast<double>(water.highest_q8) / Q8::kOne;
    row("water", concat(water.width, " x ", water.depth, " columns from ", water.corner.x, ",",
                        water.corner.y, ", level ", shortest(level)));
  }
  row("effects", effects_text(called_for(lit, used)));
}

// How many materials of each kind.
std::string describe(const LitDescription& lit, const UsedMaterials& used) {
  constexpr std::array kKindNames{"diffuse", "metal", "glass", "emit",
                                  "media"};  // in the order of `SurfaceKind`
  std::array<int, kKindNames.size()> kinds{};
  int used_count = 0;
  for (std::size_t index = 0; index < kMaxSurfaces; ++index) {
    if (used.is[index]) {
      ++used_count;
      ++kinds[static_cast<std::size_t>(lit.surfaces[index].kind)];
    }
  }
  std::vector<std::string> counts;
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
    if (kinds[kind] != 0) {
      counts.push_back(concat(kinds[kind], " ", kKindNames[kind]));
    }
  }
  return concat(used_count, counts.empty() ? "" : ": ", joined(counts, ", "));
}

// What only a baked scene has.
template <class Row>
void describe(const BakedScene& baked, const Row& row) {
  row("format version", std::to_string(kBakedVersion));
  const ConstBytes name = baked.section(SectionKind::kName);
  if (!name.empty()) {
    row("made from", printable({reinterpret_cast<const char*>(name.data), name.size}));
  }
  row("crc32", crc_text(baked.crc32()));
  row("baked bytes", grouped(baked.bytes().size));
  std::string sections;
  std::size_t content = 0;
  constexpr std::array<std::pair<const char*, SectionKind>, 7> kSections{
      {{"tree", SectionKind::kTree},
       {"palette", SectionKind::kPalette},
       {"camera", SectionKind::kCamera},
       {"brick map", SectionKind::kBrickMap},
       {"name", SectionKind::kName},
       {"lighting", SectionKind::kLighting},
       {"look", SectionKind::kLook}}};
  for (const auto& [what, kind] : kSections) {
    const std::size_t size = baked.section(kind).size;
    content += size;
    sections += size == 0 ? "" : concat(what, " ", grouped(size), ", ");
  }
  row("sections", sections + "rest " + grouped(baked.bytes().size - content));
  row("palette entries", std::to_string(baked.palette().size));
  row("camera", baked.has_camera() ? describe(baked.camera()) : "none");
  std::vector<std::string> fits;
  BakedLighting lighting;
  const bool is_lit = BakedLighting::open(baked.section(SectionKind::kLighting), baked.tree().level(),
                                          &lighting) == Status::kOk;
  for (const platform::BoardFacts& board : platform::boards()) {
    if (baked.bytes().size <= scene_flash_bytes(board, is_lit ? lighting.effects : Effect::kNone)) {
      fits.emplace_back(board.name);
    }
  }
  row("fits the flash of", fits.empty() ? "no board" : joined(fits, ", "));
}

void run(const SceneOptions& options) {
  OutputSet outputs({options.stats_path}, {options.arguments.scene});
  std::string text;
  const auto row = [&](const std::string& label, const std::string& value) {
    text += label + std::string(21 - label.size(), ' ') + value + "\n";
  };
  const auto source = options.open();
  const BuiltScene built = options.build(*source);
  const VoxelBox box = built.bounds();
  const double a_voxel = static_cast<double>(built.tree_bytes()) / static_cast<double>(built.voxels());

  row("scene", printable(options.arguments.scene));
  row("kind", source->kind());
  if (source->is_mesh()) {
    row("up in the file", source->is_z_up() ? "z" : "y (--z-up says otherwise)");
  }
  for (const std::string& note : source->notes()) {
    row("note", note);
  }
  row("depth", concat(built.level(), " (a world of ", 1 << built.level(), " voxels a side)"));
  if (source->points() != 0) {
    row("points", grouped(source->points()));
  }
  row("solid voxels", grouped(built.voxels()));
  row("occupied box", box.empty() ? "none"
                                  : concat(box.low.x, ",", box.low.y, ",", box.low.z, " to ", box.high.x, ",",
                                           box.high.y, ",", box.high.z, " (exclusive)"));

  const UsedMaterials used = used_materials(*source);
  const LitDescription lit = source->lighting();
  row("materials", describe(lit, used));
  describe(lit, used, row);

  if (built.nodes() != 0) {
    row("nodes", grouped(built.nodes()));
  }
  row("structure bytes",
      grouped(built.tree_bytes()) + (built.voxels() == 0 ? "" : " (" + fixed(a_voxel, 2) + " a voxel)"));
  row("most bytes in use", grouped(built.high_water_bytes()));
  if (built.solid_added() != 0) {
    row("solid added", counted(built.solid_added(), "voxel") + ", by coarsening");
  }
  if (built.structure() == StructureKind::kCompact) {
    uint32_t place = 0;
    const char* fault =
        CompactTree::validate({built.compact().bytes(), built.compact().size_bytes()}, &place);
    fail_if(fault != nullptr, "the compact tree is not sound at ", place, ": ", fault);
    row("compact tree", "sound");
  }
  Stats stats(options, *source, built);
  if (const BakedScene* baked = source->baked()) {
    describe(*baked, row);
    stats.baked_bytes = baked->bytes().size;
    stats.baked_crc32 = crc_text(baked->crc32());
  }
  outputs.write(0, stats_text(stats));
  outputs.commit();
  OutputFile output("-");
  output.write(text);
  output.commit();
}

}  // namespace

void add_info(CLI::App& app) {
  CLI::App* sub = add_command(app, "info", "Validate a scene and say what it is and what it takes.");
  SceneOptions* const options = options_for<SceneOptions>(*sub, run);
  options->add_to(*sub);
}

}  // namespace thimble::tools
