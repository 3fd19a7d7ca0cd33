#include "instruments/accuracy_study.h"

#include <algorithm>
#include <cmath>

#include "output/plot.h"
#include "output/units.h"
#include "readers/source.h"

namespace thimble::tools {
namespace {

// Three digits that count.
std::string brief_ms(double value) {
  return fixed(value, value >= 100 ? 0 : value >= 10 ? 1 : value >= 1 ? 2 : 3);
}

std::string decibels(double psnr_db) {
  return std::isfinite(psnr_db) ? fixed(psnr_db, 2) : "equal";
}

std::string options_of(const AccuracyRow& row) {
  if (row.light != LightSetting{}) {
    return row.light.text();
  }
  const std::string text = row.setting.text();
  return text.empty() ? "(none: the defaults)" : text;
}

JsonRow known(int value) {
  return value < 0 ? JsonRow(nullptr) : JsonRow(value);
}

// All columns, with what each row has in them; the others are null.
JsonRow object_of(const char* kind, const AccuracyRow& row) {
  const Setting& setting = row.setting;
  JsonRow object;
  put_all(&object, "row", kind, "group", row.group, "options", nullptr, "front", row.front ? 1 : 0,
          "max_depth", setting.quality.max_depth, "cutoff_px",
          static_cast<double>(setting.quality.cutoff.raw) / Q16::kOne, "direction_bits",
          setting.direction_bits, "samples", setting.quality.samples(), "wrong_px", row.wrong_px,
          "visible_px", row.visible_px, "rms_error", rms_of(row.psnr_db), "psnr_db",
          std::isfinite(row.psnr_db) ? JsonRow(row.psnr_db) : JsonRow(nullptr));
  row.add_to(&object);
  put_all(&object, "rays", row.counts.rays, "hits", row.counts.hits, "node_visits", row.counts.node_visits);
  put_nulls(&object, {"silhouette_px", "depth_error_mean_voxels", "depth_error_max_voxels",
                      "lm3s6965evb_instructions", "visits_given", "inexact_px", "error_bound_grays",
                      "mean_error_grays", "occlusion_rays", "roughness_rays", "bounces"});
  return object;
}

// What tables leave out: combinations off the front.
bool is_left_out(const AccuracyRow& row) {
  return row.group == "together" && !row.front;
}

std::string settings_table(const AccuracyStudy& study) {
  std::size_t together = 0;
  const auto make = [&](const AccuracyRow& row) {
    together += row.group == "together" ? 1U : 0U;
    if (is_left_out(row)) {
      return Cells();
    }
    Cells cells{row.front ? "*" : ""};
    for (const double value : row.setting.values()) {
      cells.push_back(value == 0 ? "-" : shortest(value));
    }
    const double pixels = static_cast<double>(study.pixels);
    const Cells measured =
        cells_of(brief_ms(row.ms_median), row.spread(), decibels(row.psnr_db), fixed(rms_of(row.psnr_db), 2),
                 percent(row.wrong_px, study.pixels), fixed(row.depth_mean_voxels, 3),
                 fixed(static_cast<double>(row.counts.node_visits) / pixels, 2),
                 fixed(row.lm3s_instructions / 1e6, 1));
    cells.insert(cells.end(), measured.begin(), measured.end());
    return cells;
  };
  const std::string table = table_of({"", "depth", "cut px", "bits", "samples", "ms", "+-%", "PSNR", "RMS",
                                      "wrong %", "depth off", "visits", "M instr"},
                                     1, study.rows, make);
  return "each knob alone, then those of " + grouped(together) +
         " combinations that are on the front, last the reference\n"
         "(*: nothing nearer to the reference is as cheap, give or take 3 per cent of time; -: default)\n" +
         table;
}

std::string work_table(const AccuracyStudy& study) {
  const auto cells = [&](const WorkRow& row) {
    return cells_of(grouped(row.given_visits), brief_ms(row.picture.ms_median), row.picture.spread(),
                    percent(study.pixels - row.inexact_px, study.pixels), fixed(row.error_bound_grays, 2),
                    fixed(row.mean_error_grays, 2), decibels(row.picture.psnr_db),
                    fixed(rms_of(row.picture.psnr_db), 2), percent(row.picture.wrong_px, study.pixels));
  };
  return "\na frame of the default setting stopped early; bound, error: how far it can be and how far it is\n"
         "from the finished one, mean absolute greys; PSNR, RMS, wrong: against the reference\n" +
         table_of({"visits given", "ms", "+-%", "exact %", "bound", "error", "PSNR", "RMS", "wrong %"}, 0,
                  study.work, cells);
}

std::string light_table(const AccuracyStudy& study) {
  const auto rays_of = [](int value) { return value < 0 ? std::string("-") : std::to_string(value); };
  const auto cells = [&](const AccuracyRow& row) {
    const double pixels = static_cast<double>(study.pixels);
    return is_left_out(row) ? Cells()
                            : cells_of(row.front ? "*" : "", rays_of(row.light.occlusion_rays),
                                       rays_of(row.light.roughness_rays), rays_of(row.light.bounces),
                                       brief_ms(row.ms_median), row.spread(), decibels(row.psnr_db),
                                       fixed(rms_of(row.psnr_db), 2), percent(row.wrong_px, study.pixels),
                                       fixed(static_cast<double>(row.counts.rays) / pixels, 2),
                                       fixed(static_cast<double>(row.counts.node_visits) / pixels, 2));
  };
  return "\nlight: " + effects_text(study.effects) + "\nagainst " + study.light_reference.text() +
         ", one sample a pixel\nfirst what the scene asks for, each knob alone, then combinations on the "
         "front; rays and "
         "visits\na pixel\n" +
         table_of({"", "occlusion", "roughness", "bounces", "ms", "+-%", "PSNR", "RMS", "wrong %", "rays",
                   "visits"},
                  1, study.light, cells);
}

// The rows of each group as a cloud of that name, error against cost.
std::vector<Cloud> clouds_of(const std::vector<AccuracyRow>& rows, CostAxis axis,
                             const std::vector<std::pair<const char*, const char*>>& groups) {
  std::vector<Cloud> clouds;
  for (const auto& [group, name] : groups) {
    Cloud cloud{name, {}, false};
    for (const AccuracyRow& row : rows) {
      if (row.group == group && cost_of(row, axis) > 0) {
        cloud.points.emplace_back(cost_of(row, axis), row.psnr_db);
      }
    }
    if (!cloud.points.empty()) {
      clouds.push_back(cloud);
    }
  }
  return clouds;
}

// The front's points of those rows, by cost.
std::vector<FrontPoint> front_of(const std::vector<AccuracyRow>& rows, CostAxis axis) {
  std::vector<FrontPoint> front;
  for (const AccuracyRow& row : rows) {
    if (row.front && cost_of(row, axis) > 0) {
      front.push_back({cost_of(row, axis), row.psnr_db, options_of(row)});
    }
  }
  std::sort(front.begin(), front.end(), [](const FrontPoint& a, const FrontPoint& b) { return a.x < b.x; });
  return front;
}

const char* axis_label(CostAxis axis) {
  return axis == CostAxis::kTime     ? "processor time of a frame, ms (median, this machine; log scale)"
         : axis == CostAxis::kVisits ? "nodes visited a frame (the same on every machine; log scale)"
                                     : "instructions a frame, lm3s6965evb (estimate; log scale)";
}

const char* axis_title(CostAxis axis) {
  return axis == CostAxis::kTime ? "time" : axis == CostAxis::kVisits ? "work" : "instructions";
}

// Error against cost of rows whose errors are those from `reference`.
Scatter scatter_of(const std::vector<AccuracyRow>& rows, CostAxis axis, const std::string& what,
                   const std::string& reference, const std::string& scene,
                   const std::vector<std::pair<const char*, const char*>>& groups) {
  Scatter scatter;
  scatter.title = what + axis_title(axis) + ": " + scene_title(scene);
  scatter.x_label = axis_label(axis);
  scatter.y_label = "PSNR against " + reference + ", dB";
  scatter.infinite_name = "upper edge: equal to " + reference;
  scatter.clouds = clouds_of(rows, axis, groups);
  scatter.front = front_of(rows, axis);
  return scatter;
}

std::string answer(const std::string& question, const AccuracyRow& row) {
  return "\n" + question + (row.light != LightSetting{} ? "\nlight: " : "\noptions: ") + options_of(row) +
         "\n  " + brief_ms(row.ms_median) + " ms, RMS error " + fixed(rms_of(row.psnr_db), 2) +
         " of 255, PSNR " + decibels(row.psnr_db) + (std::isfinite(row.psnr_db) ? " dB\n" : "\n");
}

// Rendering draws a scene's light unless --shade is given.
std::string unlit_advice(const AccuracyStudy& study) {
  return study.effects == Effect::kNone
             ? ""
             : "  with --shade as given here; without it thimble render draws light\n";
}

std::string light_answer(const AccuracyRow* row) {
  if (row == nullptr) {
    return {};
  }
  const int bounces = row->light.bounces;
  return answer("lit pictures, against the best light", *row) +
         (bounces < 0 ? ""
                      : "  --bounces " + std::to_string(bounces) +
                            " of thimble render; all else of it stands in the scene\n");
}

}  // namespace

JsonRow accuracy_objects(const AccuracyStudy& study) {
  JsonRow rows = JsonRow::array();
  for (const AccuracyRow& row : study.rows) {
    JsonRow object = object_of("setting", row);
    put_all(&object, "options", row.setting.text(), "silhouette_px", row.silhouette_px,
            "depth_error_mean_voxels", row.depth_mean_voxels, "depth_error_max_voxels", row.depth_max_voxels,
            "lm3s6965evb_instructions", row.lm3s_instructions);
    rows.push_back(object);
  }
  for (const WorkRow& row : study.work) {
    JsonRow object = object_of("anytime", row.picture);
    put_all(&object, "visits_given", row.given_visits, "inexact_px", row.inexact_px, "error_bound_grays",
            row.error_bound_grays, "mean_error_grays", row.mean_error_grays);
    rows.push_back(object);
  }
  for (const AccuracyRow& row : study.light) {
    JsonRow object = object_of("light", row);
    put_all(&object, "occlusion_rays", known(row.light.occlusion_rays), "roughness_rays",
            known(row.light.roughness_rays), "bounces", known(row.light.bounces));
    rows.push_back(object);
  }
  return rows;
}

std::string accuracy_tables(const AccuracyStudy& study, CostAxis axis) {
  return "reference: " + study.reference.text() +
         "\nPSNR in dB, RMS in 1/255: channels against the reference; wrong: of another colour; depth off:\n"
         "mean error of distance in voxels; +-%: half the quartiles' distance; visits: nodes a pixel;\n"
         "M instr: millions of instructions on lm3s6965evb, estimated; front by " +
         axis_title(axis) + "\n\n" + settings_table(study) + (study.work.empty() ? "" : work_table(study)) +
         (study.light.empty() ? "" : light_table(study));
}

std::string accuracy_plot(const AccuracyStudy& study, CostAxis axis, const std::string& scene) {
  // The defaults last, over all others.
  Scatter scatter = scatter_of(study.rows, axis, "Error against ", "the reference", scene,
                               {{"together", "knobs together"},
                                {"depth", "depth alone"},
                                {"cutoff", "cut-off alone"},
                                {"direction_bits", "direction bits alone"},
                                {"samples", "samples alone"},
                                {"best", "the reference"},
                                {"default", "defaults"}});
  scatter.front_name =
      axis == CostAxis::kTime
          ? "The front: no options of thimble render in at most 3 per cent more time come nearer"
          : "The front: no other options of thimble render are both cheaper and nearer";
  // No estimate of instructions is made for frames that stop early.
  if (axis != CostAxis::kInstructions && !study.work.empty()) {
    Cloud cloud{"defaults, stopped early", {}, true};
    for (const WorkRow& row : study.work) {
      if (cost_of(row.picture, axis) > 0) {
        cloud.points.emplace_back(cost_of(row.picture, axis), row.picture.psnr_db);
      }
    }
    scatter.clouds.push_back(cloud);
  }
  if (study.light.empty()) {
    return scatter_text(scatter);
  }
  Scatter light = scatter_of(study.light, axis == CostAxis::kInstructions ? CostAxis::kVisits : axis,
                             "Light: error against ", "the best light", scene,
                             {{"together", "knobs together"},
                              {"occlusion_rays", "occlusion rays alone"},
                              {"roughness_rays", "roughness rays alone"},
                              {"bounces", "bounces alone"},
                              {"best", "the reference"},
                              {"default", "as the scene asks"}});
  light.front_name = "The front: no other light that is as cheap comes nearer";
  return stacked({scatter_text(scatter), scatter_text(light)});
}

std::string answer_for_ms(const AccuracyStudy& study, double ms) {
  const std::string question = "nearest to the reference in " + shortest(ms) + " ms a frame";
  const AccuracyRow* best = best_within(study.rows, ms);
  if (best == nullptr) {
    const AccuracyRow* fastest = fastest_with(study.rows, 0);
    throw InputError("no setting draws a frame in " + shortest(ms) + " ms here; the fastest, " +
                     options_of(*fastest) + ", takes " + brief_ms(fastest->ms_median) +
                     " ms (--size makes frames smaller)");
  }
  std::string text = answer(question, *best) + unlit_advice(study);
  const WorkRow* early = nullptr;
  for (const WorkRow& row : study.work) {
    early = row.picture.ms_median <= ms ? &row : early;
  }
  if (early != nullptr && early->picture.psnr_db > best->psnr_db) {
    text += "or a frame of the default setting stopped after " + grouped(early->given_visits) +
            " node visits (AnytimeFrame::refine):\n  " + brief_ms(early->picture.ms_median) +
            " ms, RMS error " + fixed(rms_of(early->picture.psnr_db), 2) + " of 255\n";
  }
  return text + light_answer(best_within(study.light, ms));
}

std::string answer_for_error(const AccuracyStudy& study, double rms) {
  const AccuracyRow* fastest = fastest_with(study.rows, psnr_of(rms));
  if (fastest == nullptr) {
    const AccuracyRow* nearest = &study.rows.front();
    for (const AccuracyRow& row : study.rows) {
      nearest = row.psnr_db > nearest->psnr_db ? &row : nearest;
    }
    throw InputError("no setting that was tried has an RMS error of " + shortest(rms) +
                     " of 255 or less; the nearest, " + options_of(*nearest) + ", has " +
                     fixed(rms_of(nearest->psnr_db), 2));
  }
  return answer("fastest with an RMS error of " + shortest(rms) + " of 255 at most", *fastest) +
         unlit_advice(study) + light_answer(fastest_with(study.light, psnr_of(rms)));
}

}  // namespace thimble::tools
