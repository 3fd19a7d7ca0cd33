// The module thimble._thimble: the library's scene (thimble/files.h) and three structures of the core, on NumPy's arrays.
// What a person calls stands in thimble/__init__.py, which checks shapes and turns keywords into options.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "output/hit_rows.h"
#include "particles/populated_world.h"
#include "particles/world_files.h"
#include "readers/input_error.h"
#include "readers/oct.h"
#include "readers/source.h"
#include "scene/given_ray.h"
#include "scene/workers.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/files.h"
#include "thimble/plane/bitfield.h"
#include "thimble/plane/particles.h"
#include "thimble/tree/octree.h"

namespace py = pybind11;

namespace thimble::python {
namespace {

using files::Options;
using files::Scene;
template <class Number>
using Array = py::array_t<Number, py::array::c_style>;
using Shape = std::vector<py::ssize_t>;

// What the core answers, as Python's exceptions.
void check(Status status) {
  if (status == Status::kOutOfMemory) {
    PyErr_SetString(PyExc_MemoryError, "there is no room for it in the bytes that were given");
    throw py::error_already_set();
  }
  if (status != Status::kOk) {
    throw py::value_error(status_text(status));
  }
}

py::bytes bytes_of(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Text of a file or a path, which need not be UTF-8.
py::str text_of(const std::string& text) {
  PyObject* const decoded =
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace");
  if (decoded == nullptr) {
    throw py::error_already_set();
  }
  return py::reinterpret_steal<py::str>(decoded);
}

// Refuses arrays that are not `rows` rows of three; __init__.py has said it better before.
template <class Number>
void check_rows(const Array<Number>& array, py::ssize_t rows) {
  if (array.ndim() != 2 || array.shape(1) != 3 || array.shape(0) != rows) {
    throw py::value_error("an array is not of shape (N, 3)");
  }
}

// An array that takes `content` over without a copy.
template <class Number>
Array<Number> array_of(std::vector<Number> content, const Shape& shape) {
  auto kept = std::make_unique<std::vector<Number>>(std::move(content));
  Number* const first = kept->data();
  const py::capsule owner(kept.release(), [](void* at) { delete static_cast<std::vector<Number>*>(at); });
  return Array<Number>(shape, first, owner);
}

// What `run` gives, which other threads of Python need not wait for.
template <class Run>
auto without_lock(const Run& run) {
  const py::gil_scoped_release unlocked;
  return run();
}

// ---- Rays.

// Where the answers of all rays go; a miss is -1, and infinitely far.
struct HitArrays {
  explicit HitArrays(py::ssize_t rays)
      : hit(rays),
        voxel(Shape{rays, 3}),
        t(rays),
        distance(rays),
        axis(rays),
        material(rays),
        color(Shape{rays, 3}) {}
  // Any number of threads at a time, which hold no lock.
  void put(std::size_t at, const Ray& ray, const Hit& from, Span<const Rgb8> palette) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const bool is_hit = from.kind == HitKind::kHit;
    hit.mutable_data()[at] = is_hit;
    t.mutable_data()[at] = is_hit ? tools::hit_t(from) : kNever;
    distance.mutable_data()[at] = is_hit ? tools::hit_distance(ray, from) : kNever;
    axis.mutable_data()[at] = is_hit ? from.axis : std::int8_t{-1};
    material.mutable_data()[at] = is_hit ? from.material : std::int16_t{-1};
    const Rgb8 seen = is_hit ? palette[from.material] : Rgb8{};
    for (int i = 0; i < 3; ++i) {
      voxel.mutable_data()[3 * at + static_cast<std::size_t>(i)] = is_hit ? from.voxel[i] : -1;
    }
    std::memcpy(color.mutable_data() + 3 * at, &seen, 3);
  }
  py::tuple all() const { return py::make_tuple(hit, voxel, t, distance, axis, material, color); }

  Array<bool> hit;
  Array<std::int32_t> voxel;
  Array<double> t;
  Array<double> distance;
  Array<std::int8_t> axis;
  Array<std::int16_t> material;
  Array<std::uint8_t> color;
};

constexpr std::size_t kRaysAtOnce = 4096;

py::tuple trace(const Scene& scene, const Array<double>& origins, const Array<double>& directions,
                int threads) {
  const py::ssize_t rows = origins.size() / 3;
  check_rows(origins, rows);
  check_rows(directions, rows);
  const auto count = static_cast<std::size_t>(rows);
  HitArrays arrays(rows);
  const double* const from = origins.data();
  const double* const along = directions.data();
  const std::size_t tasks = (count + kRaysAtOnce - 1) / kRaysAtOnce;
  std::vector<std::string> faults(tasks);
  without_lock([&] {
    const tools::RayRules rules{scene.tree().level()};
    tools::each_task(tasks, threads, [&](std::size_t task, std::size_t /*worker*/) {
      const std::size_t first = task * kRaysAtOnce;
      const std::size_t rays_here = std::min(kRaysAtOnce, count - first);
      std::vector<Ray> rays(rays_here);
      std::vector<Hit> hits(rays_here);
      for (std::size_t i = 0; i < rays_here; ++i) {
        const std::size_t at = 3 * (first + i);
        const std::string fault = tools::quantised_ray(
            {from[at], from[at + 1], from[at + 2], along[at], along[at + 1], along[at + 2]}, rules, &rays[i]);
        if (!fault.empty()) {
          faults[task] = "ray " + std::to_string(first + i) + ": " + fault;
          return;
        }
      }
      (void)scene.trace({rays.data(), rays_here}, {hits.data(), rays_here});  // rays within the limits
      for (std::size_t i = 0; i < rays_here; ++i) {
        arrays.put(first + i, rays[i], hits[i], scene.palette());
      }
    });
  });
  for (const std::string& fault : faults) {
    if (!fault.empty()) {
      throw py::value_error(fault);
    }
  }
  return arrays.all();
}

// ---- Pictures and voxels of a scene.

Array<std::uint8_t> render(const Scene& scene, std::int32_t width, std::int32_t height,
                           const Options& options) {
  files::Image image = without_lock([&] { return scene.render(width, height, options); });
  return array_of(std::move(image.pixels), {image.height_px, image.width_px, image.channels});
}

py::bytes render_png(const Scene& scene, std::int32_t width, std::int32_t height, const Options& options) {
  return bytes_of(without_lock([&] { return files::png(scene.render(width, height, options)); }));
}

Array<float> depth_image(const Scene& scene, std::int32_t width, std::int32_t height, const Options& options,
                         int threads) {
  std::vector<float> depths;
  without_lock([&] {
    const Camera camera = scene.camera(width, height, options);
    const auto row = static_cast<std::size_t>(width);
    depths.assign(row * static_cast<std::size_t>(height), std::numeric_limits<float>::infinity());
    tools::each_task(static_cast<std::size_t>(height), threads, [&](std::size_t y, std::size_t /*worker*/) {
      std::vector<Ray> rays(row);
      std::vector<Hit> hits(row);
      for (std::size_t x = 0; x < row; ++x) {
        rays[x] = camera.ray(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y));
      }
      (void)scene.trace({rays.data(), row}, {hits.data(), row});  // a camera's rays are within the limits
      for (std::size_t x = 0; x < row; ++x) {
        if (hits[x].kind == HitKind::kHit) {
          depths[y * row + x] = static_cast<float>(tools::hit_distance(rays[x], hits[x]));
        }
      }
    });
  });
  return array_of(std::move(depths), {height, width});
}

// Positions and materials, in the tree's order.
py::tuple voxels(const Scene& scene) {
  const CompactTree& tree = scene.tree();
  const auto count = static_cast<py::ssize_t>(tree.voxel_count());
  Array<std::int32_t> positions(Shape{count, 3});
  Array<std::uint8_t> materials(count);
  std::int32_t* position = positions.mutable_data();
  std::uint8_t* material = materials.mutable_data();
  without_lock([&] {
    tools::walk_blocks(tree, [&](const Vec3i& corner, int level, std::uint8_t of_block) {
      tools::for_voxels(corner, level, [&](std::int32_t x, std::int32_t y, std::int32_t z) {
        *position++ = x;
        *position++ = y;
        *position++ = z;
        *material++ = of_block;
      });
    });
  });
  return py::make_tuple(positions, materials);
}

Array<std::uint8_t> palette_of(const Scene& scene) {
  const Span<const Rgb8> colors = scene.palette();
  Array<std::uint8_t> rows(Shape{static_cast<py::ssize_t>(colors.size), 3});
  static_assert(sizeof(Rgb8) == 3);
  std::memcpy(rows.mutable_data(), colors.data, 3 * colors.size);
  return rows;
}

void bind_scene(py::module_& module) {
  py::class_<Scene>(module, "Scene")
      .def(py::init<const std::string&, const Options&>(), py::call_guard<py::gil_scoped_release>())
      .def(py::init([](const py::bytes& content, const std::string& name, const Options& options) {
        const std::string_view bytes = content;
        return without_lock([&] {
          return std::make_unique<Scene>(
              ConstBytes{reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, name, options);
        });
      }))
      .def("trace", trace, py::arg("origins").noconvert(), py::arg("directions").noconvert(),
           py::arg("threads"))
      .def("render", render)
      .def("render_png", render_png)
      .def("depth_image", depth_image)
      .def("voxels", voxels)
      .def("palette", palette_of)
      .def("bake",
           [](const Scene& scene, const Options& options) {
             return bytes_of(without_lock([&] { return scene.bake(options); }));
           })
      .def("memory", &Scene::memory, py::call_guard<py::gil_scoped_release>())
      .def("write", &Scene::write, py::call_guard<py::gil_scoped_release>())
      .def("kind", &Scene::kind)
      .def("notes",
           [](const Scene& scene) {
             py::list notes;
             for (const std::string& note : scene.notes()) {
               notes.append(text_of(note));
             }
             return notes;
           })
      .def("has_colors", &Scene::has_colors)
      .def("level", [](const Scene& scene) { return scene.tree().level(); })
      .def("voxel_count", [](const Scene& scene) { return scene.tree().voxel_count(); })
      .def("tree_bytes", [](const Scene& scene) { return scene.tree().size_bytes(); })
      .def("bounds", [](const Scene& scene) {
        const VoxelBox& box = scene.tree().bounds();
        return py::make_tuple(py::make_tuple(box.low.x, box.low.y, box.low.z),
                              py::make_tuple(box.high.x, box.high.y, box.high.z));
      });
}

// ---- The core's structures in bytes of their own.

class OwnOctree {
 public:
  OwnOctree(int level, std::size_t nodes)
      : bytes_(std::make_unique_for_overwrite<std::uint8_t[]>(Octree::octree_bytes(nodes))) {
    check(Octree::make(level, {bytes_.get(), Octree::octree_bytes(nodes)}, &tree_));
  }
  Octree& tree() { return tree_; }

  std::size_t insert_all(const Array<std::int32_t>& positions, const Array<std::uint8_t>& materials) {
    check_rows(positions, materials.size());
    std::vector<Voxel> voxels(static_cast<std::size_t>(materials.size()));
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      const std::int32_t* at = positions.data() + 3 * i;
      voxels[i] = {{at[0], at[1], at[2]}, materials.data()[i]};
    }
    std::size_t inserted = 0;
    check(tree_.insert_all({voxels.data(), voxels.size()}, inserted));
    return inserted;
  }

  // A scene's bytes: `palette` is 256 x 3 or empty.
  py::bytes baked(const Array<std::uint8_t>& palette) const {
    check_rows(palette, palette.size() / 3);
    std::size_t size = 0;
    (void)CompactTree::make(tree_, Bytes(), nullptr, &size);  // says how large it is
    std::vector<std::uint8_t> tree_bytes(size);
    CompactTree compact;
    check(CompactTree::make(tree_, {tree_bytes.data(), tree_bytes.size()}, &compact));
    std::vector<Rgb8> colors(static_cast<std::size_t>(palette.size()) / 3);
    std::memcpy(colors.data(), palette.data(), 3 * colors.size());
    BakedParts parts;
    parts.tree = {compact.bytes(), compact.size_bytes()};
    parts.palette = {colors.data(), colors.size()};
    std::vector<std::uint8_t> bytes(baked_bytes(parts));
    check(BakedScene::make(parts, {bytes.data(), bytes.size()}, nullptr));
    return bytes_of(bytes);
  }

 private:
  std::unique_ptr<std::uint8_t[]> bytes_;
  Octree tree_;
};

void bind_octree(py::module_& module) {
  py::class_<OwnOctree>(module, "Octree")
      .def(py::init<int, std::size_t>())
      .def("insert",
           [](OwnOctree& own, std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
             check(own.tree().insert({x, y, z}, material));
           })
      .def("insert_all", &OwnOctree::insert_all, py::arg("positions").noconvert(),
           py::arg("materials").noconvert())
      .def("insert_box",
           [](OwnOctree& own, const std::array<std::int32_t, 3>& low, const std::array<std::int32_t, 3>& high,
              std::uint8_t material) {
             check(own.tree().insert_box({{low[0], low[1], low[2]}, {high[0], high[1], high[2]}}, material));
           })
      .def("remove",
           [](OwnOctree& own, std::int32_t x, std::int32_t y, std::int32_t z) {
             check(own.tree().remove({x, y, z}));
           })
      .def("material",
           [](OwnOctree& own, std::int32_t x, std::int32_t y, std::int32_t z) {
             return own.tree().material({x, y, z});
           })
      .def("coarsen_to", [](OwnOctree& own, std::size_t nodes) { check(own.tree().coarsen_to(nodes)); })
      .def("clear", [](OwnOctree& own) { own.tree().clear(); })
      .def("level", [](OwnOctree& own) { return own.tree().level(); })
      .def("nodes", [](OwnOctree& own) { return own.tree().nodes_used(); })
      .def("capacity", [](OwnOctree& own) { return own.tree().capacity(); })
      .def("voxel_count", [](OwnOctree& own) { return own.tree().voxels(); })
      .def("solid_added", [](OwnOctree& own) { return own.tree().solid_added(); })
      .def("baked", &OwnOctree::baked, py::arg("palette").noconvert());
}

Array<bool> cells_of(const BitField& field) {
  Array<bool> cells(Shape{field.height(), field.width()});
  bool* cell = cells.mutable_data();
  for (std::int32_t y = 0; y < field.height(); ++y) {
    for (std::int32_t x = 0; x < field.width(); ++x) {
      *cell++ = field.test({x, y});
    }
  }
  return cells;
}

class OwnField {
 public:
  OwnField(std::int32_t width, std::int32_t height) : bytes_(bitfield_bytes(width, height)) {
    check(BitField::make(width, height, Bytes{bytes_.data(), bytes_.size()}, &field_));
  }
  BitField& field() { return field_; }
  std::size_t size_bytes() const { return bytes_.size(); }

 private:
  std::vector<std::uint8_t> bytes_;
  BitField field_;
};

void bind_field(py::module_& module) {
  using Box = std::array<std::int32_t, 4>;
  using Cell = std::int32_t;
  const auto box_of = [](const Box& box) { return CellBox{{box[0], box[1]}, {box[2], box[3]}}; };
  py::class_<OwnField>(module, "BitField")
      .def(py::init<std::int32_t, std::int32_t>())
      .def("set_box", [box_of](OwnField& own, const Box& box) { own.field().set(box_of(box)); })
      .def("clear_box", [box_of](OwnField& own, const Box& box) { own.field().clear(box_of(box)); })
      .def("count", [box_of](OwnField& own, const Box& box) { return own.field().count(box_of(box)); })
      .def("set_disc",
           [](OwnField& own, Cell diameter, Cell x, Cell y) {
             own.field().set(disc_stamp(diameter), {x, y});
           })
      .def("clear_disc",
           [](OwnField& own, Cell diameter, Cell x, Cell y) {
             own.field().clear(disc_stamp(diameter), {x, y});
           })
      .def("any_disc",
           [](OwnField& own, Cell diameter, Cell x, Cell y) {
             return own.field().any(disc_stamp(diameter), {x, y});
           })
      .def("test",
           [](OwnField& own, Cell x, Cell y) {
             return own.field().test({x, y});
           })
      .def("array", [](OwnField& own) { return cells_of(own.field()); })
      .def("size_bytes", &OwnField::size_bytes);
}

using tools::PopulatedWorld;

// Number, place, speed, diameter and sleep of each ball, in the order of their numbers.
py::tuple balls_of(const PopulatedWorld& populated) {
  const auto count = static_cast<py::ssize_t>(populated.world().count());
  Array<std::uint32_t> ids(count);
  Array<double> places(Shape{count, 2});
  Array<double> speeds(Shape{count, 2});
  Array<std::int32_t> diameters(count);
  Array<bool> asleep(count);
  std::size_t i = 0;
  tools::for_each_ball(populated.world(), [&](const Particle& ball) {
    constexpr double kCell = 65536;
    ids.mutable_data()[i] = ball.id;
    places.mutable_data()[2 * i] = ball.x_q16 / kCell;
    places.mutable_data()[2 * i + 1] = ball.y_q16 / kCell;
    speeds.mutable_data()[2 * i] = ball.vx_q16 / kCell;
    speeds.mutable_data()[2 * i + 1] = ball.vy_q16 / kCell;
    diameters.mutable_data()[i] = ball.diameter;
    asleep.mutable_data()[i] = ball.asleep;
    ++i;
  });
  return py::make_tuple(ids, places, speeds, diameters, asleep);
}

void bind_particles(py::module_& module) {
  py::class_<PopulatedWorld>(module, "Particles")
      .def(py::init([](std::int32_t width, std::int32_t height, std::uint32_t count,
                       const std::array<std::int32_t, 2>& diameters, double bounciness,
                       const std::array<double, 2>& gravity, std::uint32_t seed, double speed) {
        tools::WorldOptions options;
        options.width = width;
        options.height = height;
        options.count = count;
        options.least_diameter = diameters[0];
        options.most_diameter = diameters[1];
        options.bounciness = bounciness;
        // Beyond these limits, and those of the command, numbers would wrap round.
        const auto most = [](double number) { return std::abs(number) <= 8192; };  // NaN is not
        if (!most(gravity[0]) || !most(gravity[1]) || !most(speed) || speed < 0 || !(bounciness >= 0) ||
            bounciness > 1) {
          throw files::Error("a value of the world is beyond its limits");
        }
        options.gravity_q16 = {static_cast<std::int32_t>(std::lround(gravity[0] * 65536)),
                               static_cast<std::int32_t>(std::lround(gravity[1] * 65536))};
        options.seed = seed;
        options.speed = speed;
        try {
          return std::make_unique<PopulatedWorld>(options, std::nullopt);
        } catch (const tools::InputError& error) {
          throw files::Error(error.what());
        }
      }))
      .def(
          "step",
          [](PopulatedWorld& populated, std::uint32_t steps) {
            for (std::uint32_t i = 0; i < steps; ++i) {
              populated.world().step();
            }
          },
          py::call_guard<py::gil_scoped_release>())
      .def("balls", balls_of)
      .def("field", [](const PopulatedWorld& populated) { return cells_of(populated.world().field()); })
      .def("image",
           [](const PopulatedWorld& populated) {
             std::vector<std::uint8_t> rgb;
             tools::draw_world(populated, &rgb);
             const BitField& field = populated.world().field();
             return array_of(std::move(rgb), {field.height(), field.width(), 3});
           })
      .def("steps", [](const PopulatedWorld& populated) { return populated.world().steps(); })
      .def("crc32", [](const PopulatedWorld& populated) { return populated.world().state_crc32(); })
      .def("size_bytes", [](const PopulatedWorld& populated) { return populated.world().used_bytes(); });
}

}  // namespace
}  // namespace thimble::python

PYBIND11_MODULE(_thimble, module) {
  module.attr("__version__") = THIMBLE_VERSION;
  static const py::exception<thimble::files::Error> error(module, "Error", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const thimble::files::Error& caught) {
      PyErr_SetObject(error.ptr(), thimble::python::text_of(caught.what()).ptr());
    }
  });
  thimble::python::bind_scene(module);
  thimble::python::bind_octree(module);
  thimble::python::bind_field(module);
  thimble::python::bind_particles(module);
}
