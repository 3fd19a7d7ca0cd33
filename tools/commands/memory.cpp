// thimble memory: what a scene takes at every depth in every structure, which boards hold it, and what a
// smaller depth or budget does to its picture.
#include "commands/commands.h"
#include "instruments/memory_study.h"
#include "output/plot.h"
#include "scene/board_fit.h"

namespace thimble::tools {
namespace {

constexpr std::array<const char*, kMemoryStructures> kTitles{"dense", "pool", "compact", "DAG"};
constexpr std::array<std::string_view, kMemoryStructures> kColumnNames{"dense", "pool", "compact",
                                                                       "dag"};  // of columns
constexpr std::uint64_t kFourGiB = std::uint64_t{1} << 32;
// The paper's picture, and as deep as it is wide.
constexpr std::uint64_t kPaperLayer = 800 * 600;
constexpr std::uint64_t kPaperDepth = 800;

struct MemoryCommand {
  SceneOptions scene;
  StudyOptions study;
  ReportPaths files;
};

// Bytes of a dense grid in which each unit of space holds that.
std::uint64_t dense_bytes(std::uint64_t units, std::size_t stored) {
  return (units + 7) / 8 + units * kStoredBytes[stored];
}

// The grid of most layers of 800 x 600 that 4 GiB hold.
std::uint64_t layers_in_4_gib(std::size_t stored) {
  // 480,000 is a multiple of 8, so each layer takes the same.
  return kFourGiB / dense_bytes(kPaperLayer, stored);
}

// The deepest cube that 4 GiB hold.
int deepest_cube(std::size_t stored) {
  int depth = 0;
  while (dense_bytes(std::uint64_t{1} << (3 * (depth + 1)), stored) <= kFourGiB) {
    ++depth;
  }
  return depth;
}

// Whether the board can draw it: trees that are only read lie in flash, what is built on the chip in RAM.
bool fits_board(const platform::BoardFacts& board, const MemoryStudy& study, std::size_t structure,
                const StructureFigures& figures) {
  return structure == kCompact || structure == kShared
             ? ((figures.bytes + 3) & ~std::uint64_t{3}) + study.around_tree_bytes <= scene_flash_bytes(board)
             : drawing_ram_bytes(board) + figures.build_bytes <= board.ram_bytes;
}

std::string boards_that_fit(const MemoryStudy& study, const DepthRow& row, std::size_t structure) {
  std::string names;
  for (const platform::BoardFacts& board : platform::boards()) {
    if (fits_board(board, study, structure, row.structures[structure])) {
      names += (names.empty() ? "" : ";") + std::string(board.name);
    }
  }
  return names;
}

// The error of the picture at a depth; null for none.
const PictureError* error_at(const MemoryStudy& study, int depth) {
  return depth == 0 ? nullptr : &study.depths[static_cast<std::size_t>(depth) - 1].error;
}

// --- rows for machines -------------------------------------------------------------------------------------

void add_error(const std::string& prefix, const PictureError* error, JsonRow* object) {
  const auto add = [&](const char* name, auto figure) {
    (*object)[prefix + name] = error == nullptr ? JsonRow(nullptr) : JsonRow(error->*figure);
  };
  add("wrong_px", &PictureError::wrong_px);
  add("silhouette_px", &PictureError::silhouette_px);
  add("depth_error_mean_voxels", &PictureError::depth_mean_voxels);
  add("depth_error_max_voxels", &PictureError::depth_max_voxels);
}

JsonRow depth_object(const MemoryStudy& study, const DepthRow& row) {
  JsonRow object;
  const auto add_each = [&](const std::string& name, const auto& figure_of) {
    for (std::size_t i = 0; i < kMemoryStructures; ++i) {
      object[std::string(kColumnNames[i]) + name] = figure_of(row.structures[i]);
    }
  };
  put_all(&object, "row", "depth", "depth", row.depth, "grid",
          concat(row.grid.x, "x", row.grid.y, "x", row.grid.z), "units", row.units, "stored", "scene",
          "voxels", row.voxels, "leaves", row.leaves, "pool_nodes", row.pool_nodes, "compact_nodes",
          row.compact_nodes, "dag_nodes", row.dag_nodes);
  add_each("_bytes", [](const StructureFigures& figures) { return figures.bytes; });
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    for (std::size_t stored = 0; stored < kStoredKinds; ++stored) {
      const double bytes = static_cast<double>(row.structures[i].stored_bytes[stored]);
      object[std::string(kColumnNames[i]) + "_" + kStoredNames[stored] + "_bytes_per_voxel"] =
          row.voxels == 0 ? JsonRow(nullptr) : JsonRow(bytes / static_cast<double>(row.voxels));
    }
  }
  add_each("_build_bytes", [](const StructureFigures& figures) { return figures.build_bytes; });
  object["dag_table_bytes"] = row.dag_table_bytes;
  add_each("_frame_ms", [](const StructureFigures& figures) { return json_of(figures.frame_ms); });
  add_each("_visits_per_ray",
           [](const StructureFigures& figures) { return json_of(figures.visits_per_ray); });
  add_error("", &row.error, &object);
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    object[std::string(kColumnNames[i]) + "_boards"] = boards_that_fit(study, row, i);
  }
  return object;
}

// The paper's sum has no scene: of a row's columns only those of a dense grid.
JsonRow paper_object(const JsonRow& like, std::uint64_t layers, std::size_t stored, const char* row) {
  JsonRow object;
  for (const auto& [name, value] : like.items()) {
    object[name] = nullptr;
  }
  const std::uint64_t units = kPaperLayer * layers;
  put_all(&object, "row", row, "grid", concat("800x600x", layers), "units", units, "stored",
          kStoredNames[stored], "dense_bytes", dense_bytes(units, stored));
  return object;
}

JsonRow depth_objects(const MemoryStudy& study) {
  JsonRow rows = objects_of(study.depths, [&](const DepthRow& row) { return depth_object(study, row); });
  const JsonRow like = rows.front();
  for (std::size_t stored = 0; stored < kStoredKinds; ++stored) {
    rows.push_back(paper_object(like, 1, stored, "paper"));
    rows.push_back(paper_object(like, kPaperDepth, stored, "paper"));
    rows.push_back(paper_object(like, layers_in_4_gib(stored), stored, "paper_4_gib"));
  }
  return rows;
}

JsonRow budget_objects(const MemoryStudy& study) {
  return objects_of(study.budgets, [&](const BudgetRow& row) {
    JsonRow object;
    object["budget_bytes"] = row.budget_bytes;
    for (std::size_t i = 0; i < kMemoryStructures; ++i) {
      object[std::string(kColumnNames[i]) + "_depth"] = row.depth[i];
    }
    add_error("compact_", error_at(study, row.depth[kCompact]), &object);
    add_error("dag_", error_at(study, row.depth[kShared]), &object);
    object["coarsened_bytes"] = json_of(row.coarsened_bytes);
    object["coarsened_solid_added_voxels"] =
        row.coarsened_bytes ? JsonRow(row.solid_added) : JsonRow(nullptr);
    add_error("coarsened_", row.coarsened_bytes ? &row.coarsened_error : nullptr, &object);
    return object;
  });
}

// --- tables for people -------------------------------------------------------------------------------------

std::string dash_or(const std::optional<double>& value, int digits) {
  return value ? fixed(*value, digits) : "-";
}

// How many bytes a voxel those are.
std::string share_of(std::uint64_t bytes, const DepthRow& row) {
  return row.voxels == 0 ? "-" : fixed(static_cast<double>(bytes) / static_cast<double>(row.voxels), 2);
}

std::string bytes_table(const MemoryStudy& study) {
  const auto cells = [](const DepthRow& row) {
    const auto bytes = [&](std::size_t structure) { return row.structures[structure].bytes; };
    return cells_of(row.depth, grouped(row.voxels), grouped(bytes(kDense)), grouped(bytes(kPool)),
                    grouped(bytes(kCompact)), share_of(bytes(kCompact), row), grouped(bytes(kShared)),
                    share_of(bytes(kShared), row));
  };
  return "bytes\n" + table_of({"depth", "voxels", "dense", "pool", "compact", "/voxel", "DAG", "/voxel"}, 0,
                              study.depths, cells);
}

std::string stored_table(const MemoryStudy& study) {
  const DepthRow& own = study.depths.back();
  if (own.voxels == 0) {
    return {};
  }
  std::vector<Cells> rows{{"bytes a voxel", "bit alone", "+ color", "+ normal", "+ opacity"}};
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    Cells cells{kTitles[i]};
    for (const std::uint64_t bytes : own.structures[i].stored_bytes) {
      cells.push_back(share_of(bytes, own));
    }
    rows.push_back(cells);
  }
  return concat(
      "\nwhat is stored at a place (depth ", own.depth,
      "): color 1 byte, normal 2, opacity 1, at every unit of a dense\ngrid, at every solid block and "
      "voxel of a tree\n",
      columns_of(rows, 1));
}

// A row a depth, and for each structure what `text_of` says of it.
template <class... TextOf>
std::string depth_table(const Cells& head, const MemoryStudy& study, const TextOf&... text_of) {
  return table_of(head, 0, study.depths, [&](const DepthRow& row) {
    Cells cells = cells_of(row.depth);
    const auto add_each = [&](const auto& text) {
      std::transform(row.structures.begin(), row.structures.end(), std::back_inserter(cells), text);
    };
    (add_each(text_of), ...);
    return cells;
  });
}

std::string building_table(const MemoryStudy& study) {
  return "\nmost bytes in use while building\n" +
         depth_table({"depth", "dense", "pool", "compact", "DAG"}, study,
                     [](const StructureFigures& figures) { return grouped(figures.build_bytes); });
}

std::string picture_table(const MemoryStudy& study) {
  const auto cells = [&](const DepthRow& row) {
    const PictureError& error = row.error;
    return cells_of(row.depth, grouped(error.wrong_px), percent(error.wrong_px, study.pixels),
                    grouped(error.silhouette_px), percent(error.silhouette_px, study.pixels),
                    fixed(error.depth_mean_voxels, 2), fixed(error.depth_max_voxels, 1));
  };
  return "\nthe picture against the deepest: pixels of another colour, pixels hit in one only, error of the\n"
         "distance where both hit, in voxels of the deepest\n" +
         table_of({"depth", "wrong px", "%", "silhouette px", "%", "depth mean", "depth max"}, 0,
                  study.depths, cells);
}

std::string frame_table(const MemoryStudy& study) {
  return "\nprocessor time of a frame (median, structures by turns) and nodes visited a ray (dense: "
         "cells)\n" +
         depth_table(
             {"depth", "dense ms", "pool ms", "compact ms", "DAG ms", "dense visits", "pool visits",
              "compact visits", "DAG visits"},
             study, [](const StructureFigures& figures) { return dash_or(figures.frame_ms, 2); },
             [](const StructureFigures& figures) { return dash_or(figures.visits_per_ray, 2); });
}

std::string boards_table(const MemoryStudy& study) {
  const auto cells = [&](const platform::BoardFacts& board) {
    const auto deepest = [&](std::size_t structure) {
      int depth = 0;
      for (const DepthRow& row : study.depths) {
        depth = fits_board(board, study, structure, row.structures[structure]) ? row.depth : depth;
      }
      return depth == 0 ? std::string("-") : std::to_string(depth);
    };
    const std::uint64_t drawing = drawing_ram_bytes(board);
    return cells_of(board.name, grouped(scene_flash_bytes(board)), deepest(kCompact), deepest(kShared),
                    grouped(board.ram_bytes > drawing ? board.ram_bytes - drawing : 0), deepest(kPool),
                    deepest(kDense));
  };
  return concat(
      "\nthe deepest depth that each board holds, of ", study.depths.back().depth,
      ": baked in flash, or built in RAM\n",
      table_of({"board", "flash for a scene", "compact", "DAG", "RAM beside drawing", "pool", "dense"}, 1,
               platform::boards(), cells));
}

std::string paper_table() {
  std::vector<Cells> rows{{"the paper's sum", "units", "bit alone", "+ color", "+ normal", "+ opacity"}};
  const auto sizes = [](std::uint64_t units, Cells cells) {
    for (std::size_t stored = 0; stored < kStoredKinds; ++stored) {
      cells.push_back(grouped(dense_bytes(units, stored)));
    }
    return cells;
  };
  rows.push_back(sizes(kPaperLayer, {"800 x 600 x 1", grouped(kPaperLayer)}));
  rows.push_back(sizes(kPaperLayer * kPaperDepth, {"800 x 600 x 800", grouped(kPaperLayer * kPaperDepth)}));
  Cells layers{"layers of 800 x 600 in 4 GiB", ""};
  Cells cubes{"deepest cube in 4 GiB", ""};
  for (std::size_t stored = 0; stored < kStoredKinds; ++stored) {
    layers.push_back(grouped(layers_in_4_gib(stored)));
    cubes.push_back("depth " + std::to_string(deepest_cube(stored)));
  }
  rows.push_back(layers);
  rows.push_back(cubes);
  return "\n" + columns_of(rows, 1) +
         "The paper ran out of 4 GB \"with just a few levels of depth\": ten layers of 800 x 600 are then " +
         grouped(kFourGiB / (10 * kPaperLayer)) + "\nbytes a unit.\n";
}

std::string budget_table(const MemoryStudy& study) {
  const auto make = [&](const BudgetRow& row) {
    Cells cells{grouped(row.budget_bytes)};
    const auto add = [&](const Cells& more) { cells.insert(cells.end(), more.begin(), more.end()); };
    const auto add_picture = [&](const PictureError* error) {
      add(error == nullptr
              ? Cells{"-", "-"}
              : cells_of(percent(error->wrong_px, study.pixels), fixed(error->depth_mean_voxels, 2)));
    };
    for (const int depth : row.depth) {
      add({depth == 0 ? "-" : std::to_string(depth)});
    }
    add_picture(error_at(study, row.depth[kCompact]));
    add(row.coarsened_bytes ? cells_of(grouped(*row.coarsened_bytes), grouped(row.solid_added))
                            : Cells{"-", "-"});
    add_picture(row.coarsened_bytes ? &row.coarsened_error : nullptr);
    return cells;
  };
  return "\nthe deepest depth whose bytes fit a budget and the compact one's picture; the whole depth "
         "coarsened\n"
         "to fit, the voxels added and its picture (depth: mean error of distance)\n" +
         table_of({"budget", "dense", "pool", "compact", "DAG", "wrong %", "depth", "coarsened", "added",
                   "wrong %", "depth"},
                  0, study.budgets, make);
}

// --- plots -------------------------------------------------------------------------------------------------

std::string depth_plot(const MemoryCommand& command, const MemoryStudy& study) {
  Plot plot;
  plot.title = "Memory against depth: " + scene_title(command.scene.arguments.scene);
  plot.x_label = "depth (a world of 2^depth voxels a side)";
  plot.y_label = "bytes (log scale)";
  plot.whole_x = true;
  constexpr std::array<const char*, kMemoryStructures> kPlotNames{
      "dense grid, a bit a unit", "pool, 8 bytes a node", "compact tree, no pointers",
      "DAG, equal subtrees once"};
  double most = 0;
  const auto add = [&](const char* name, std::size_t structure, std::uint64_t StructureFigures::*figure) {
    const bool is_building = figure == &StructureFigures::build_bytes;
    Series& series = plot.series.emplace_back(Series{name, is_building, {}});
    for (const DepthRow& row : study.depths) {
      const auto bytes = static_cast<double>(row.structures[structure].*figure);
      if (bytes > 0) {
        series.points.emplace_back(row.depth, bytes);
        most = std::max(most, is_building ? 0 : bytes);
      }
    }
  };
  for (std::size_t i = 0; i < kMemoryStructures; ++i) {
    add(kPlotNames[i], i, &StructureFigures::bytes);
  }
  add("compact tree, while building", kCompact, &StructureFigures::build_bytes);
  add("DAG, while building", kShared, &StructureFigures::build_bytes);
  for (const Mark& mark :
       {Mark{16.0 * 1024, "16 KiB"}, Mark{256.0 * 1024, "256 KiB"},
        Mark{static_cast<double>(kPaperLayer * kPaperDepth) / 8, "the paper's 800 x 600 x 800, a bit a unit"},
        Mark{static_cast<double>(kFourGiB), "4 GiB"}}) {
    if (mark.y <= 4 * most) {
      plot.marks.push_back(mark);
    }
  }
  return log_plot_text(plot);
}

std::string budget_plot(const MemoryCommand& command, const MemoryStudy& study) {
  Plot plot;
  plot.title = "Picture error against budget: " + scene_title(command.scene.arguments.scene);
  plot.x_label = "budget for the structure, bytes (log scale)";
  plot.y_label = "mean depth error, voxels of the deepest (log; 0 not shown)";
  Series compact{"compact tree, the depth that fits", false, {}};
  Series dag{"DAG, the depth that fits", false, {}};
  Series coarsened{"compact tree, coarsened to fit", false, {}};
  for (const BudgetRow& row : study.budgets) {
    const double budget = static_cast<double>(row.budget_bytes);
    const auto add = [&](Series* series, const PictureError* error) {
      // What is exact has no place on a logarithmic axis.
      if (error != nullptr && error->depth_mean_voxels > 0 && budget > 0) {
        series->points.emplace_back(budget, error->depth_mean_voxels);
      }
    };
    add(&compact, error_at(study, row.depth[kCompact]));
    add(&dag, error_at(study, row.depth[kShared]));
    add(&coarsened, row.coarsened_bytes ? &row.coarsened_error : nullptr);
  }
  plot.series = {compact, dag, coarsened};
  return log_plot_text(plot);
}

void run(const MemoryCommand& command) {
  ReportFiles files(command.files, command.scene.arguments.scene);
  const auto source = command.scene.open();
  const MemoryStudy study = with_progress("measuring", command.scene.quiet, [&](const Progress& progress) {
    return study_memory(*source, command.scene.arguments.scene, command.study, progress);
  });
  const bool sweep = command.study.budget_sweep;
  const std::string plot = !files.wants_plot() ? ""
                           : sweep             ? budget_plot(command, study)
                                               : depth_plot(command, study);
  files.write(sweep ? budget_objects(study) : depth_objects(study), plot);
  print_notes({study.note}, command.scene.quiet);
  files.print(printable(command.scene.arguments.scene) + "\n\n" + bytes_table(study) + stored_table(study) +
              building_table(study) + picture_table(study) +
              (command.study.frames > 0 ? frame_table(study) : "") + boards_table(study) + paper_table() +
              (study.budgets.empty() ? "" : budget_table(study)));
}

}  // namespace

std::string memory_json(const MemoryStudy& study) {
  return depth_objects(study).dump();
}

void add_memory(CLI::App& app) {
  CLI::App* sub = add_command(
      app, "memory",
      "Memory against depth: for every depth from 1 to the scene's own the bytes of a dense bit grid, the "
      "mutable pool, the compact tree and the DAG (equal subtrees once), bytes while building, time of a "
      "frame, nodes visited, the picture's error against the deepest, and the boards that hold it. A voxel "
      "of a lower depth is the parent block of finer voxels, solid when anything in it is.");
  MemoryCommand* const command = options_for<MemoryCommand>(*sub, run);
  command->scene.add_scene(*sub);
  add_bytes(*sub, "--memory", &command->study.budget_bytes,
            "also the deepest depth whose structure fits so many bytes, such as 65536, 64K or 2M (the "
            "structure alone: renderer, band and building not counted)");
  add_flag(*sub, "--budget-sweep", &command->study.budget_sweep,
           "the same for 1 KiB, 2 KiB, ... until the whole scene fits, and what coarsening to the "
           "budget does to the picture; --csv, --json and --plot then hold this");
  add_whole_option(*sub, "--frames", "N", 0, 99, &command->study.frames,
                   "frames timed for each depth and structure; 0: none, no times and visits");
  add_view(*sub, &command->study.view);
  add_shade(*sub, &command->study.shade,
            "what a wrong pixel is: of another brightness by distance, by the face's direction, of another "
            "palette colour, or hit or not");
  add_report(
      *sub, &command->files, &command->scene.quiet,
      "a line a depth: row (depth; or paper, paper_4_gib: the paper's sum, dense columns only), depth, grid "
      "(of the dense grid), units (its cells), stored (what dense_bytes holds a unit; scene: a bit), voxels "
      "(solid), leaves (solid blocks and voxels of a tree), pool_nodes, compact_nodes, dag_nodes; for S of "
      "dense, pool, compact, dag: S_bytes, S_bit_bytes_per_voxel, S_color_bytes_per_voxel (palette index), "
      "S_normal_bytes_per_voxel (and 2 bytes), S_opacity_bytes_per_voxel (and 1 byte), S_build_bytes (most "
      "in use while building), dag_table_bytes (of that, the hash table that the DAG is built in), "
      "S_frame_ms (processor time, median), S_visits_per_ray (nodes; dense: cells), S_boards (compact, dag: "
      "in flash; dense, pool: in RAM); wrong_px (another colour than the deepest depth's), silhouette_px "
      "(hit in one only), depth_error_mean_voxels, depth_error_max_voxels (in voxels of the deepest). With "
      "--budget-sweep a line a budget: budget_bytes, S_depth (deepest that fits, 0: none), compact_... and "
      "dag_... (those errors at that depth), coarsened_bytes, coarsened_solid_added_voxels, coarsened_... "
      "(errors of the compact tree of the whole depth, coarsened to fit)",
      "bytes against depth; with --budget-sweep mean depth error against budget");
}

}  // namespace thimble::tools
