// The command's parts behind one object (thimble/files.h).
#include <mutex>

#include "commands/bake_command.h"
#include "commands/render_command.h"
#include "instruments/memory_study.h"
#include "output/voxel_file.h"
#include "thimble/files.h"

namespace thimble::files {
namespace {

using namespace thimble::tools;

// What is thrown inside, as the one thing that comes out.
template <class Run>
auto with_error(const Run& run, const std::string& subject = {}) {
  try {
    return run();
  } catch (const InputError& error) {
    throw Error((subject.empty() ? "" : subject + ": ") + error.what());
  } catch (const OutputError& error) {
    throw Error(error.what());
  } catch (const CLI::ParseError& error) {  // options that make no sense together
    throw Error(error.what());
  }
}

// The system ends a path at its first zero byte: it would open another file.
void check_text(const std::string& word) {
  if (word.find('\0') != std::string::npos) {
    throw Error(in_quotes(word) + " has a zero byte, which no path and no option has");
  }
}

// What `words` say as options of `thimble NAME`. `is_open`: none of those that say how a scene is opened.
template <class Add>
void parse(const std::string& name, const Options& words, bool is_open, const Add& add) {
  CLI::App app("", "thimble");
  app.require_subcommand(1);
  CLI::App* sub = add_command(app, name, "");
  sub->set_help_flag();  // nobody reads it here
  add(*sub);
  when_chosen(*sub, [&] {
    CLI::App opening;
    SceneOptions().add_scene(opening);
    for (const std::string& option : options_given(*sub)) {
      refuse_if(is_open && option.starts_with("-") && opening.get_option_no_throw(option) != nullptr, option,
                ": says how a scene is opened, and this one is open");
    }
  });
  for (const std::string& word : words) {
    check_text(word);
  }
  Options reversed(words.rbegin(), words.rend());  // as CLI11 takes them
  reversed.push_back(name);
  try {
    app.parse(reversed);
  } catch (const CLI::ParseError& error) {
    throw Error(usage_sentence(app, error, name));
  }
}

// `options` and what else the command wants; the scene's name is no word of theirs.
Options with_words(Options more, const Options& options, const std::string& scene) {
  more.insert(more.end(), options.begin(), options.end());
  more.insert(more.end(), {"--quiet", "--", scene});
  return more;
}

std::string size_text(std::int32_t width_px, std::int32_t height_px) {
  return std::to_string(width_px) + "x" + std::to_string(height_px);
}

SceneOptions opening(const std::string& scene, const Options& options) {
  SceneOptions opened;
  parse("info", with_words({}, options, scene), false, [&](CLI::App& app) {
    opened.add_scene(app);
    add_flag(app, "--quiet", &opened.quiet, "");
  });
  opened.build_threads = all_cores();
  return opened;
}

}  // namespace

struct Scene::Parts {
  explicit Parts(const SceneOptions& options)
      : arguments(options.arguments),
        source(options.open()),
        built(options.build(*source)),
        shape(shape_of(*source, built)),
        lighting(source->lighting()) {
    const UsedMaterials used = used_materials(built.compact());
    effects = chosen_effects(lighting, used, EffectChoice{});
    lighting.find_glow(built.compact());
    light = lit_scene_for(lighting, used, effects);
    source->keep(&built.compact());  // what is made of the source copies it
    if (arguments.content) {
      arguments.content = SharedBytes();  // so that no file of this name is opened in their place
    }
  }

  RenderCommand render_command(std::int32_t width_px, std::int32_t height_px, const Options& options) const {
    RenderCommand command;
    parse(
        "render",
        with_words({"-o", "picture.png", "--size", size_text(width_px, height_px)}, options, arguments.scene),
        true, [&](CLI::App& app) { add_render_options(app, &command); });
    return command;
  }

  SceneArguments arguments;  // it was opened with
  std::unique_ptr<SceneSource> source;
  mutable BuiltScene built;  // whose arena gets the map of many rays
  SceneShape shape;
  LitDescription lighting;
  EffectSet effects = Effect::kNone;
  LitScene light;  // views into `lighting`
  mutable std::once_flag has_map;
  mutable FirstHits first_hits;
};

Scene::Scene(const std::string& scene, const Options& options) {
  parts_ = with_error([&] { return std::make_unique<const Parts>(opening(scene, options)); }, scene);
}

Scene::Scene(ConstBytes bytes, const std::string& name, const Options& options) {
  parts_ = with_error(
      [&] {
        SceneOptions opened = opening(name, options);
        opened.arguments.content =
            SharedBytes::own(std::string(reinterpret_cast<const char*>(bytes.data), bytes.size));
        return std::make_unique<const Parts>(opened);
      },
      name);
}

Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

std::unique_ptr<Scene> Scene::open(const std::string& scene, const Options& options,
                                   std::string* error) noexcept {
  try {
    return std::make_unique<Scene>(scene, options);
  } catch (const std::exception& caught) {
    if (error != nullptr) {
      *error = caught.what();
    }
    return nullptr;
  }
}

const std::string& Scene::kind() const {
  return parts_->source->kind();
}
const std::vector<std::string>& Scene::notes() const {
  return parts_->source->notes();
}
const CompactTree& Scene::tree() const {
  return parts_->built.compact();
}
Span<const Rgb8> Scene::palette() const {
  return {parts_->built.palette().data(), parts_->built.palette().size()};
}
bool Scene::has_colors() const {
  return parts_->source->has_colors();
}
const LitScene& Scene::light() const {
  return parts_->light;
}
EffectSet Scene::effects() const {
  return parts_->effects;
}

Status Scene::trace(Span<const Ray> rays, Span<Hit> hits) const {
  constexpr std::size_t kRaysForMap = 1000;  // fewer are not worth the map
  if (hits.size < rays.size) {
    return Status::kBadArgument;
  }
  if (rays.size >= kRaysForMap) {
    std::call_once(parts_->has_map, [&] { parts_->first_hits = wide_first_hits(&parts_->built); });
    if (parts_->first_hits) {
      return parts_->first_hits(rays, hits);
    }
  }
  Status status = Status::kOk;
  for (std::size_t i = 0; i < rays.size && status == Status::kOk; ++i) {
    status = closest_hit(tree(), rays[i], &hits[i]);
  }
  return status;
}

Camera Scene::camera(std::int32_t width_px, std::int32_t height_px, const Options& options) const {
  return with_error([&] {
    return frame_scene(parts_->render_command(width_px, height_px, options).view, *parts_->source,
                       parts_->shape)
        .camera;
  });
}

Image Scene::render(std::int32_t width_px, std::int32_t height_px, const Options& options) const {
  return with_error([&] {
    RenderCommand command = parts_->render_command(width_px, height_px, options);
    Image taken;
    command.output.take = [&](const tools::Image& image) {
      taken = {image.width_px, image.height_px, image.alpha.empty() ? 3 : 4,
               file_pixels(image, ImageKind::kPng)};
    };
    tools::render(command, *parts_->source);
    return taken;
  });
}

std::vector<std::uint8_t> Scene::bake(const Options& options) const {
  return with_error([&] {
    BakeCommand command;
    parse("bake", with_words({"-o", "scene.oct"}, options, parts_->arguments.scene), true,
          [&](CLI::App& app) { add_bake_options(app, &command); });
    fail_if(!command.scene.stats_path.empty(), "--stats is a file, which only the command writes");
    command.scene.arguments = parts_->arguments;  // whose smaller depths are tried where it does not fit
    use_display(command.scene.board, &command.view);
    BakingOptions baking;
    const Baked baked = tools::bake(&command, *parts_->source, &baking);
    return std::vector<std::uint8_t>(baked.bytes.begin(), baked.bytes.end());
  });
}

std::string Scene::memory(int frames) const {
  return with_error([&] {
    fail_if(frames < 0 || frames > 99, "frames is 0 to 99, not ", frames);
    StudyOptions options;
    options.frames = frames;
    return memory_json(study_memory(*parts_->source, parts_->arguments.scene, options, [](double) {}));
  });
}

void Scene::write(const std::string& path) const {
  with_error([&] {
    check_text(path);
    const auto format = voxel_format(path);
    fail_if(!format || tree().empty(),
            format ? "nothing is solid" : path + " does not end in .vox, .npy, .ply or .csv");
    OutputSet outputs({path}, parts_->source->files());
    write_voxels(outputs[0], *format, tree(), parts_->source->palette(), has_colors(), {});
    outputs.commit();
  });
}

std::vector<std::uint8_t> png(const Image& image) {
  if (image.width_px < 1 || image.height_px < 1 || image.channels < 1 || image.channels > 4 ||
      image.pixels.size() != static_cast<std::uint64_t>(image.width_px) *
                                 static_cast<std::uint64_t>(image.height_px) *
                                 static_cast<std::uint64_t>(image.channels)) {
    throw Error("an image has other pixels than its sizes say");
  }
  return png_file(image.width_px, image.height_px, image.channels, image.pixels);
}

}  // namespace thimble::files
