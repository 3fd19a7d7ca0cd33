#include "readers/read_any.h"

#include "readers/text.h"

namespace thimble::tools {

namespace {

FormatReader read_zip;

/// The scene in an archive: what a reader knows by name or beginning. Text that may be anything is one only where
/// nothing else is.
ZipMember scene_member(const SharedBytes& file) {
  std::vector<ZipMember> scenes;
  std::vector<ZipMember> texts;
  for (const ZipMember& member : zip_members(file)) {
    const std::string_view name = member.name.substr(member.name.rfind('/') + 1);
    if (name.empty() || name.starts_with('.') || member.name.starts_with("__MACOSX/")) {
      continue;  // folders, and what systems leave
    }
    const SharedBytes beginning = zip_beginning(member, kFirstLookBytes);
    const ReaderRow* const row = find_reader(name, beginning.text());
    if (row == nullptr || row->read == read_zip ||
        (row->beginning == Beginning::kMagic && !row->knows(beginning.text()))) {
      continue;
    }
    (name.ends_with(".txt") ? texts : scenes).push_back(member);
  }
  scenes = scenes.empty() ? texts : scenes;
  if (scenes.size() == 1) {
    return scenes[0];
  }
  fail_if(scenes.empty(), "the archive holds no scene");
  throw InputError("the archive holds ", scenes.size(), " scenes, ", quoted(scenes[0].name), " and ",
                   quoted(scenes[1].name), scenes.size() > 2 ? " among them" : "",
                   "; unpack the one that is meant");
}

Source read_zip(const SharedBytes& file, const ReadOptions& options, const Progress& progress) {
  const ZipMember member = scene_member(file);
  ReadOptions inside = options;  // what it names is looked for beside the archive
  inside.path = options.path.substr(0, options.path.rfind('/') + 1) +
                std::string(member.name.substr(member.name.rfind('/') + 1));
  return read_any(inside, zip_unpack(member), progress);
}

// The one place that knows all formats. Where two recognise the same bytes, the first one counts.
constexpr std::array<ReaderRow, 27> kRows{{
    {".vox", "MagicaVoxel model", read_vox, nullptr, Beginning::kMagic, "VOX "},
    {".ply", "PLY mesh or points", read_ply, looks_like_ply, Beginning::kMagic},
    {".obj", "Wavefront mesh", read_obj, nullptr, Beginning::kText},
    {".off", "OFF mesh", read_off, looks_like_off, Beginning::kText},
    {".stl", "STL mesh", read_stl, looks_like_stl},
    {".glb .gltf", "glTF scene", read_gltf, looks_like_gltf, Beginning::kMagic},
    {".xyz .csv .txt .tsv .pts", "points, one a line", read_xyz, nullptr, Beginning::kText},
    {".pcd", "PCL point cloud", read_pcd, looks_like_pcd, Beginning::kMagic},
    {".las", "LAS laser scan", read_las, nullptr, Beginning::kMagic, "LASF"},
    {".laz", "compressed LAS laser scan", read_las, nullptr, Beginning::kMagic, "LASF"},
    {".dat", "Gadget-1 snapshot", read_gadget, looks_like_gadget, Beginning::kMagic},
    {".oct", "baked scene", read_oct, nullptr, Beginning::kMagic, "TMS"},
    {".scene", "scene text", read_scene_text, nullptr, Beginning::kText},
    {".binvox", "binvox grid", read_binvox, nullptr, Beginning::kMagic, "#binvox"},
    {".npy", "NumPy array", read_npy, looks_like_npy, Beginning::kMagic},
    {".npz", "NumPy archive", read_npy, nullptr, Beginning::kAny},
    {".zip", "archive of one scene", read_zip, nullptr, Beginning::kAny, "PK\x03\x04"},
    {".asc", "grid of heights", read_height_grid, looks_like_height_grid, Beginning::kMagic},
    {".mts", "Minetest schematic", read_mts, nullptr, Beginning::kMagic, "MTSM"},
    {".schematic .schem .litematic .nbt", "Minecraft schematic", read_schematic, looks_like_schematic,
     Beginning::kMagic},
    {".bt .ot", "OctoMap octree", read_octomap, looks_like_octomap, Beginning::kMagic},
    {".qb", "Qubicle model", read_qb, nullptr},
    {".qbcl", "Qubicle project", read_qbcl, nullptr, Beginning::kMagic, "QBCL"},
    {".kvx", "KVX model", read_kvx, nullptr},
    {".kv6", "KV6 model", read_kv6, nullptr, Beginning::kMagic, "Kvxl"},
    {".vxl", "Voxlap map", read_vxl, nullptr, Beginning::kAny, kVoxlapMagic},
    {".gox", "Goxel scene", read_gox, nullptr, Beginning::kMagic, "GOX "},
}};

bool has_ending(std::string_view path, std::string_view ending) {
  return path.size() > ending.size() &&
         equals_ignoring_case(path.substr(path.size() - ending.size()), ending);
}

const ReaderRow& row_for(std::string_view path, std::string_view text) {
  const ReaderRow* row = find_reader(path, text);
  fail_if(row == nullptr,
          "neither the name nor the contents tell what this file is; thimble info --help lists what is read");
  return *row;
}

/// Refuses first bytes that are those of no text that means anything.
void check_text(std::span<const std::uint8_t> first, const char* name) {
  refuse_zero_bytes(first, name);
  const bool is_blank = std::all_of(first.begin(), first.end(),
                                    [](std::uint8_t byte) { return is_space(static_cast<char>(byte)); });
  fail_if(is_blank && first.size() >= kFirstLookBytes, "begins with ", first.size(),
          " blanks and empty lines, and no text");
}

}  // namespace

std::span<const ReaderRow> reader_rows() {
  return kRows;
}

const ReaderRow* find_reader(std::string_view path, std::string_view text) {
  for (const ReaderRow& row : kRows) {
    if (row.knows(text)) {
      return &row;
    }
  }
  for (const std::string_view packed : {".gz", ".zst", ".xz"}) {
    if (has_ending(path, packed)) {
      path.remove_suffix(packed.size());
      break;
    }
  }
  for (const ReaderRow& row : kRows) {
    std::string_view endings = row.endings;
    for (std::string_view ending = take_word(endings); !ending.empty(); ending = take_word(endings)) {
      if (has_ending(path, ending)) {
        return &row;
      }
    }
  }
  return nullptr;
}

void check_beginning(std::string_view path, std::span<const std::uint8_t> first) {
  const SharedBytes file{first, nullptr};
  const ReaderRow& row = row_for(path, file.text());
  if (row.beginning == Beginning::kMagic && !row.knows(file.text())) {
    row.read(file, {}, {});  // says how such a file begins
  }
  if (row.beginning == Beginning::kText) {
    check_text(first, row.name);
  }
}

Source read_any(const ReadOptions& options, const SharedBytes& file, const Progress& progress) {
  const ReaderRow& row = row_for(options.path, file.text());
  fail_if(options.frame && row.read != read_vox && row.read != read_zip,
          "--frame and --frames are for .vox files with frames, and this is of another kind (", row.name,
          ")");
  fail_if(options.as != ArrayAs::kByShape && row.read != read_npy && row.read != read_zip,
          "--as-points and --as-heights are for .npy and .npz, and this is of another kind (", row.name, ")");
  constexpr std::array kColorGuessers{read_las, read_npy, read_obj, read_off,
                                      read_pcd, read_ply, read_xyz, read_zip};
  fail_if(options.full_color != 0 &&
              std::find(kColorGuessers.begin(), kColorGuessers.end(), row.read) == kColorGuessers.end(),
          "--colors is for formats that do not say what a full color is, and this is of another kind (",
          row.name, ")");
  Source source = row.read(file, options, progress);
  tell(progress, 1);
  return source;
}

Source read_scene_file(const ReadOptions& options, const Progress& progress) {
  const FirstLook look = [&](std::span<const std::uint8_t> first) { check_beginning(options.path, first); };
  return read_any(options, load_shared(options.path, look, options.is_beside), progress);
}

}  // namespace thimble::tools
