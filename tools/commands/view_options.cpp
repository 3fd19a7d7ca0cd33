#include "commands/scene_options.h"

#include <cmath>
#include <tuple>

namespace thimble::tools {
namespace {

void add_triple(CLI::App& app, const std::string& name, std::optional<Real3>* value,
                const std::string& help) {
  add_text_option(
      app, name, "X,Y,Z",
      [value](const std::string& text) {
        return parse_reals(text, value->emplace()) ? "" : "is not three numbers X,Y,Z";
      },
      help);
}

constexpr int kMostSamples = kMaxSamplesAcross * kMaxSamplesAcross;

}  // namespace

void add_view(CLI::App& app, ViewWishes* view, bool with_direction_bits) {
  add_text_option(
      app, "--size", "WxH",
      [view](const std::string& text) -> std::string {
        const auto size = parse_pair(text, 'x', 1, kMaxPicturePx);
        if (!size) {
          return concat("is not WxH with sides of 1 to ", kMaxPicturePx, " pixels");
        }
        std::tie(view->width_px, view->height_px) = *size;
        view->sized = true;
        return {};
      },
      concat("the picture's size in pixels (default: ", view->width_px, "x", view->height_px,
             app.get_option_no_throw("--board") != nullptr ? ", or the display of --board)" : ")"));
  add_choice_option(app, "--projection", {{"perspective", false}, {"orthographic", true}},
                    &view->orthographic, "how rays leave the camera");
  add_triple(app, "--eye", &view->eye,
             "where the camera is, in voxels (default: where it sees the whole scene)");
  add_triple(app, "--target", &view->target,
             "what it looks at, in voxels (default: the middle of the scene)");
  add_triple(app, "--up", &view->up,
             "what is up in the picture (default: 0,0,1, or 0,1,0 when looking along z)");
  add_real_option(app, "--fov", "DEG", 1, 120, &view->fov_degrees,
                  "perspective: vertical field of view in degrees, 1 to 120");
  add_text_option(
      app, "--span", "V",
      [view](const std::string& text) {
        view->span = parse_real(text);
        return view->span && *view->span > 0 ? "" : "is not a number above 0";
      },
      "orthographic: width of the picture in voxels (default: the whole scene)");
  if (with_direction_bits) {
    add_direction_bits(app, &view->direction_bits);
  }
  also_check(app, [&app, view] {
    // Then the scene's own camera is not asked for.
    for (const char* const name :
         {"--projection", "--eye", "--target", "--up", "--fov", "--span", "--view", "--turn", "--tilt"}) {
      view->placed = view->placed || is_given(app, name);
    }
    refuse_if(!view->orthographic && is_given(app, "--span"),
              "--span: is the width of --projection orthographic; in perspective --fov is the angle");
    refuse_if(view->orthographic && is_given(app, "--fov"),
              "--fov: is the angle of --projection perspective; orthographic pictures have a --span");
  });
}

void add_picture_view(CLI::App& app, ViewWishes* view, bool with_direction_bits) {
  view->side = NamedView::kBest;
  view->fov_degrees = kPictureFov;
  add_choice_option(
      app, "--view",
      {{"best", NamedView::kBest},
       {"iso", NamedView::kIso},
       {"front", NamedView::kFront},
       {"back", NamedView::kBack},
       {"left", NamedView::kLeft},
       {"right", NamedView::kRight},
       {"top", NamedView::kTop},
       {"paper", NamedView::kPaper}},
      &view->side,
      "from which side the scene fills nine tenths of the picture; best: of eight three-quarter views from "
      "above the one that shows the most distinct faces and colours; iso: of the four corners; front looks "
      "along +y, left along +x; paper: where the instruments stand, which frame a box")
      ->default_str("the scene's own camera, else best");
  const auto add_angle = [&](const char* name, double* angle, double most, const char* help) {
    add_real_option(
        app, name, "DEG", -most, most, [angle](double degrees) { *angle = degrees; }, help);
  };
  add_angle("--turn", &view->onward.turn, 360,
            "go round the scene by so many degrees from there, to the right");
  add_angle("--tilt", &view->onward.tilt, 180, "rise by so many degrees from there, straight above at most");
  add_view(app, view, with_direction_bits);
  for (const char* const angle : {"--view", "--turn", "--tilt"}) {
    app.get_option(angle)->excludes(app.get_option("--eye"));
  }
}

void use_display(const platform::BoardFacts* board, ViewWishes* view) {
  if (board != nullptr && !view->sized) {
    view->width_px = board->width_px;
    view->height_px = board->height_px;
  }
}

void add_direction_bits(CLI::App& app, int* bits) {
  add_whole_option(app, "--direction-bits", "N", kMinDirectionBits, kMaxDirectionBits, bits,
                   "bits of a ray's direction, 8 to 20 (default: as many as are needed)");
}

void add_samples(CLI::App& app, int* across, bool* at_edges, const std::string& of_what,
                 const std::string& usual) {
  add_text_option(
      app, "--samples", "auto|N",
      [across, at_edges](const std::string& text) -> std::string {
        *at_edges = CLI::detail::to_lower(text) == "auto";
        const auto number = parse_whole(text, 1, kMostSamples);
        if (!*at_edges && !number) {
          return "is neither auto nor a whole number from 1 to " + std::to_string(kMostSamples);
        }
        for (*across = 1; *across * *across < number.value_or(kEdgeGrid * kEdgeGrid); ++*across) {
        }
        return {};
      },
      "samples a pixel, " + of_what +
          ": 1, 4, 9, 16, 25, 36, 49 or 64; what lies between is taken as the next of them; auto: one, and "
          "2 or 4 more where the picture of one has edges")
      ->default_str(usual);
  also_check(app, [&app, across] {
    const std::string asked = text_given(app, "--samples");
    const auto number = parse_whole(asked, 1, kMostSamples);
    const int taken = *across * *across;
    const bool quiet = is_given(app, "--quiet");
    if (number && *number != taken && !quiet) {
      std::fprintf(stderr, "note: --samples %s is not a square; %d are taken\n", asked.c_str(), taken);
    }
  });
}

void add_quality(CLI::App& app, Quality* quality) {
  add_samples(app, &quality->across, &quality->at_edges, "on a regular grid in it, averaged",
              "those of the scene's own look, else 1");
  also_check(app, [&app, quality] { quality->is_sampled = is_given(app, "--samples"); });
  add_real_option(
      app, "--cutoff", "PX", 0, kMostCutoffPx,
      [quality](double pixels) {
        quality->cutoff = Q16::from_raw(static_cast<std::int32_t>(std::lround(pixels * Q16::kOne)));
      },
      "stop at blocks of the tree that cover less than PX pixels, in their mean colour; 0 to 64, compact "
      "structure only")
      ->default_str("0");
  add_whole_option(
      app, "--max-depth", "D", kMinLevel, kMaxLevel, &quality->max_depth,
      "stop at blocks D levels down in the tree, in their mean colour: the scene as with a depth of D; "
      "compact structure only");
}

void add_shade(CLI::App& app, ShadeMode* mode, const std::string& help, std::string* given, bool has_ink) {
  std::vector<std::pair<std::string, ShadeMode>> modes{{"depth", ShadeMode::kDepth},
                                                       {"normal", ShadeMode::kNormal},
                                                       {"color", ShadeMode::kColor},
                                                       {"mono", ShadeMode::kMono}};
  if (has_ink) {
    modes.emplace_back(kInk, ShadeMode::kColor);
  }
  add_choice_option(app, "--shade", modes, mode, help)
      ->default_str(given != nullptr ? "the scene's own look" : "depth");
  if (given != nullptr) {
    also_check(app, [&app, given] { *given = text_given(app, "--shade"); });
  }
}

}  // namespace thimble::tools
