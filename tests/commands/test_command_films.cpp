// `thimble render` of animations, --camera-path with --seconds, and films as a picture a frame.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "commands/render_command.h"
#include "readers/texture.h"
#include "support/check_command.h"
#include "support/file_bytes.h"
#include "support/pictures.h"
#include "viewer/open_scene.h"

namespace {

using namespace thimble::tests;
using namespace thimble::tools;

// A .vox of models of 32 voxels a side, a frame each, without a scene graph: a red cube near the lowest corner that
// stands still, and a green one that goes up from frame to frame.
std::string animation(int frames) {
  std::string chunks;
  for (int frame = 0; frame < frames; ++frame) {
    std::vector<std::array<int, 4>> voxels;
    for (int i = 0; i < 64; ++i) {
      const auto at = [&](int shift) { return i >> shift & 3; };
      voxels.push_back({at(0), at(2), at(4), 1});
      voxels.push_back({28 + at(0), 28 + at(2), 9 * frame + at(4), 2});
    }
    chunks += vox_model({32, 32, 32}, voxels);
  }
  chunks += vox_chunk(
      "RGBA", std::string("\xff\0\0\xff", 4) + std::string("\0\xff\0\xff", 4) + std::string(1016, '\1'));
  return vox_file(chunks);
}

const Words kSmall{"--size", "48x36", "--quiet"};

}  // namespace

TEST_CASE("render: frames of an animation -> one camera, that of all of them") {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.vox", animation(3));
  std::vector<std::vector<std::size_t>> red(3);  // where each frame shows what stands still
  for (int frame = 0; frame < 3; ++frame) {
    const std::string path = folder.path("f.ppm");
    check_done(Words{"render", file, "--shade", "color", "--frame", std::to_string(frame), "-o", path} +
               kSmall);
    const std::string ppm = read_text(path).substr(13);
    for (std::size_t i = 0; i < ppm.size(); i += 3) {
      if (ppm[i] != 0 && ppm[i + 1] == 0) {
        red[static_cast<std::size_t>(frame)].push_back(i);
      }
    }
    CHECK(ppm.size() == 3 * 48 * 36);
  }
  CHECK(red[0].size() > 4);
  CHECK(red[0] == red[1]);
  CHECK(red[0] == red[2]);
}

TEST_CASE("bake: frames of an animation -> one camera, that of all of them") {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.vox", animation(3));
  std::vector<thimble::Vec3Q8> eyes;
  for (const char* const frame : {"0", "2"}) {
    const std::string path = folder.path("f.oct");
    check_done({"bake", file, "--frame", frame, "-o", path, "--quiet"});
    SceneArguments baked;
    baked.scene = path;
    eyes.push_back(open_scene(baked)->camera()->eye);
  }
  CHECK(eyes[0] == eyes[1]);
}

TEST_CASE("view: frames of an animation -> framed alike, also by a key") {
  const TemporaryFolder folder;
  SceneArguments arguments;
  arguments.scene = folder.write("a.vox", animation(3));
  const auto first = viewer::SceneReading(arguments, 1).take();
  arguments.frame = 2;
  const auto alone = viewer::SceneReading(arguments, 1).take();
  const auto after = viewer::SceneReading(arguments, 1, first).take();
  CHECK(after->shape.tree == first->shape.tree);
  for (const NamedView side : {NamedView::kBest, NamedView::kFront}) {
    const auto eye_of = [&](const viewer::OpenScene& scene) {
      ViewWishes view;
      view.side = side;
      return frame_shape(view, scene.shape).kept.eye;
    };
    CHECK(eye_of(*alone) == eye_of(*first));
    CHECK(eye_of(*after) == eye_of(*first));
  }
}

TEST_CASE(
    "render: --frames -> ten frames a second; the first is its own picture; parts and names of pictures "
    "join") {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.vox", animation(4));
  const Words render = Words{"render", file, "--frames", "1:3"} + kSmall;
  const auto at = [&](const std::string& name) { return folder.path(name); };
  check_done(render + Words{"-o", at("a.y4m")});
  const std::string y4m = read_text(at("a.y4m"));
  const std::size_t head = y4m.find('\n') + 1;
  CHECK(y4m.substr(0, head).find(" F10:1 ") != std::string::npos);
  CHECK(y4m.size() == head + 3 * (6 + 3 * 48 * 36));
  check_done(render + Words{"-o", at("a.gif")});
  check_done(render + Words{"-o", at("f%02d.png")});
  check_done(render + Words{"-o", at("f_%d.jpg")});
  check_done(Words{"render", file, "--frame", "1", "-o", at("one.png")} + kSmall);
  CHECK(read_text(at("f00.png")) == read_text(at("one.png")));
  CHECK(read_text(at("f01.png")) != read_text(at("f00.png")));
  CHECK(std::filesystem::exists(at("f_2.jpg")));
  CHECK_FALSE(std::filesystem::exists(at("f03.png")));
  check_done(render + Words{"--part", "0:1", "-o", at("0.part")});
  check_done(render + Words{"--part", "1:2", "-o", at("1.part")});
  for (const std::string name : {"a.y4m", "a.gif", "f%02d.png", "f_%d.jpg"}) {
    check_done({"join", at("1.part"), at("0.part"), "-o", at("joined-" + name)});
  }
  for (const std::string name : {"a.y4m", "a.gif", "f00.png", "f02.png", "f_0.jpg", "f_2.jpg"}) {
    CHECK(read_text(at("joined-" + name)) == read_text(at(name)));
  }
  // Of other frames.
  check_done(Words{"render", file, "--frames", "0:2", "--part", "1:2", "-o", at("2.part")} + kSmall);
  check_refused({"join", at("0.part"), at("2.part"), "-o", at("no.gif")}, 1, {"2.part", "does not belong"});
}

TEST_CASE("render: --frames and sequences asked for wrongly -> a sentence, and no file") {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.vox", animation(3));
  const std::string still = folder.write("still.vox", animation(1));
  const Words before = folder.names();
  const auto check_bad = [&](const std::string& scene, const Words& options, int status, const Words& named,
                             const std::string& name = "a.gif") {
    check_refused(Words{"render", scene, "--size", "16x12", "-o", folder.path(name)} + options, status,
                  named);
    CHECK(folder.names() == before);
  };
  check_bad(file, {"--frames", "0:3"}, 1, {"a.vox", "no frame 3", "the last is 2"});
  check_bad(file, {"--frames", "3:4"}, 1, {"a.vox", "no frame 3", "frames 0 to 2"});
  check_bad(still, {"--frames", "0:0"}, 1, {"still.vox", "it has one frame"});
  check_bad("spheres", {"--frames", "0:1"}, 2, {"--frames", "generator"});
  for (const char* const text : {"2:1", "1", ":1", "1:", "0:100000", "-1:2", "0:1:2"}) {
    check_bad(file, {"--frames", text}, 2, {"--frames", text, "A:B"});
  }
  check_bad(file, {"--frames", "0:1", "--frame", "1"}, 2, {"--frames"});
  check_bad(file, {"--frames", "0:1", "--turntable", "4"}, 2, {"--frames"});
  check_bad(file, {"--frames", "0:1", "--shade", "depth"}, 2, {"--frames", "--shade"});
  check_bad(file, {"--frames", "0:1", "--part", "1:2"}, 2, {"--part", "2 frames"}, "a.part");
  for (const char* const name : {"a.png", "a%s.png", "a%d%d.png", "a%003d.jpg", "a%.png"}) {
    check_bad(file, {"--frames", "0:1"}, 2, {"--frames", ".gif", ".y4m", "frame_%03d.png"}, name);
  }
  check_bad(file, {}, 2, {".png, .jpg, .ppm, .pgm or .pbm", ".gif or .y4m"}, "a.tga");
  check_bad(file, {"--turntable", "3"}, 1, {"nowhere"}, "nowhere/f%d.png");
}

TEST_CASE("render: a picture of a sequence that the run reads -> stays as it is, and the run is refused") {
  const TemporaryFolder folder;
  const std::string path = folder.write("f1.png", "-20,-30,20,16,16,10\n-10,-30,20,16,16,10\n");
  const std::string text = read_text(path);
  check_refused(Words{"render", "spheres", "--camera-path", path, "-o", folder.path("f%d.png")} + kSmall, 1,
                {"f1.png", "is an input"});
  CHECK(read_text(path) == text);
  CHECK(folder.names() == Words{"f1.png"});
}

TEST_CASE(
    "render: a picture of a sequence with the name of another output, or of a file read late -> refused at "
    "once") {
  const TemporaryFolder folder;
  const auto at = [&](const std::string& name) { return folder.path(name); };
  const Words film = Words{"render", "spheres", "--turntable", "3", "-o", at("f%d.png")} + kSmall;
  check_refused(film + Words{"--stats", at("f2.png")}, 1, {"f2.png", "two outputs"});
  CHECK(folder.names().empty());
  check_done(film + Words{"--stats", at("f3.png")});
  check_done(Words{"render", "spheres", "--turntable", "3", "--part", "0:3", "-o", at("f2.png.part")} +
             kSmall);
  check_refused({"join", at("f2.png.part"), "-o", at("f%d.png.part")}, 2, {"f%d.png.part"});
  // What a scene names is read after the outputs are claimed.
  const std::string picture = read_text(at("f2.png"));
  folder.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  folder.write("m.mtl", "newmtl m\nmap_Kd f2.png\n");
  const Words before = folder.names();
  check_refused(Words{"render", at("m.obj"), "--turntable", "3", "-o", at("f%d.png")} + kSmall, 1,
                {"f2.png", "is an input"});
  CHECK(read_text(at("f2.png")) == picture);
  CHECK(folder.names() == before);
}

TEST_CASE("render: an animation whose later frame is broken -> said before the first picture is written") {
  const TemporaryFolder folder;
  const auto model = [](std::size_t number, char frame) {
    return little(number, 4) + little(1, 4) + little(2, 4) + "_f" + little(1, 4) + frame;
  };
  const std::string graph =
      vox_chunk("nTRN", little(0, 4) + little(0, 4) + little(1, 4) + little(~std::size_t{0}, 4) +
                            little(~std::size_t{0}, 4) + little(1, 4) + little(0, 4)) +
      vox_chunk("nSHP", little(1, 4) + little(0, 4) + little(2, 4) + model(0, '0') + model(9, '2'));
  const std::string file = folder.write("b.vox", vox_file(vox_model({2, 2, 2}, {{0, 0, 0, 1}}) + graph));
  const Words render = Words{"render", file, "-o", folder.path("f%d.png")} + kSmall;
  check_refused(render + Words{"--frames", "0:2"}, 1, {"b.vox", "frame 2", "model 9"});
  CHECK(folder.names() == Words{"b.vox"});
  check_done(render + Words{"--frames", "0:1"});
}

TEST_CASE(
    "render: --seconds -> so many frames from key to key, on a way through them whose speed does not jump") {
  const TemporaryFolder folder;
  const std::string keys = folder.write("keys.csv",
                                        "-20,-30,20,16,16,10,0,0,1,40\n"
                                        "-10,-30,25,16,16,12,0,0,1,45\n"
                                        "0,-40,30,16,16,10,1,0,1,50\n");
  const Words render = Words{"render", "spheres", "--camera-path", keys} + kSmall;
  check_done(render + Words{"-o", folder.path("keys.y4m")});
  check_done(render + Words{"--seconds", "0.2", "-o", folder.path("film.y4m")});
  const std::string each = read_text(folder.path("keys.y4m"));
  const std::string film = read_text(folder.path("film.y4m"));
  const std::size_t head = each.find('\n') + 1;
  const std::size_t frame = 6 + 3 * 48 * 36;
  REQUIRE(film.size() == head + 11 * frame);
  for (std::size_t key = 0; key < 3; ++key) {
    CHECK(film.substr(head + 5 * key * frame, frame) == each.substr(head + key * frame, frame));
  }
  CHECK(film.substr(head + 2 * frame, frame) != film.substr(head + 3 * frame, frame));

  constexpr int kFrames = 1000;
  const CameraPath path = smoothed(read_camera_path(keys, ViewWishes{}), kFrames);
  REQUIRE(path.cameras.size() == 2 * kFrames + 1);
  for (std::size_t i = 1; i + 1 < path.cameras.size(); ++i) {
    const auto eye = [&](std::size_t at) { return path.cameras[at].view.eye.value(); };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double before = eye(i)[axis] - eye(i - 1)[axis];
      const double after = eye(i + 1)[axis] - eye(i)[axis];
      // Voxels a frame: at most 0.02 here, and straight from key to key it would jump by 0.01.
      CHECK(std::abs(after - before) < 1e-4);
      CHECK(std::abs(after) < 0.02);
    }
  }
  check_refused(Words{"render", "spheres", "--seconds", "1", "-o", folder.path("a.png")} + kSmall, 2,
                {"--seconds", "--camera-path"});
  check_refused(render + Words{"--seconds", "3600", "-o", folder.path("a.gif")}, 1,
                {"--seconds", "100,000 frames"});
}

TEST_CASE("render: a .gif of frames with colours of their own -> each in its own") {
  const TemporaryFolder folder;
  std::string chunks;
  std::string palette;
  for (int frame = 0; frame < 9; ++frame) {  // a cube of another hue each
    std::vector<std::array<int, 4>> voxels;
    for (int i = 0; i < 64; ++i) {
      voxels.push_back({i & 3, i >> 2 & 3, i >> 4 & 3, frame + 1});
    }
    chunks += vox_model({4, 4, 4}, voxels);
    for (const int channel : {28 * frame, 255 - 28 * frame, frame % 3 * 100, 255}) {
      palette += static_cast<char>(channel);
    }
  }
  chunks += vox_chunk("RGBA", palette + std::string(1024 - palette.size(), '\1'));
  const std::string file = folder.write("hues.vox", vox_file(chunks));
  check_done(Words{"render", file, "--frames", "0:8", "-o", folder.path("a.gif")} + kSmall);
  check_done(Words{"render", file, "--frames", "0:8", "-o", folder.path("f%d.ppm")} + kSmall);
  const ReadPicture gif = read_gif(read_text(folder.path("a.gif")));
  REQUIRE(gif.frames.size() == 9);
  for (std::size_t frame = 0; frame < 9; ++frame) {
    const std::string ppm = read_text(folder.path("f" + std::to_string(frame) + ".ppm")).substr(13);
    REQUIRE(gif.frames[frame].size() == ppm.size());
    double squares = 0;
    for (std::size_t i = 0; i < ppm.size(); ++i) {
      const int shown = static_cast<std::uint8_t>(gif.frames[frame][i]);
      const int wanted = static_cast<std::uint8_t>(ppm[i]);
      squares += (shown - wanted) * (shown - wanted);
    }
    CAPTURE(frame);
    CHECK(std::sqrt(squares / static_cast<double>(ppm.size())) < 10);
  }
}

TEST_CASE("render: .jpg -> the picture but for what JPEG loses; nothing transparent") {
  const TemporaryFolder folder;
  const Words render{"render", "castle", "--size", "160x120", "--quiet", "-o"};
  check_done(render + Words{folder.path("a.ppm")});
  check_done(render + Words{folder.path("a.jpg")});
  check_done(render + Words{folder.path("b.JPEG")});
  const std::string jpeg = read_text(folder.path("a.jpg"));
  CHECK(jpeg.substr(0, 3) == "\xff\xd8\xff");
  CHECK(read_text(folder.path("b.JPEG")) == jpeg);
  CHECK(jpeg.size() < 160 * 120);
  const std::string ppm = read_text(folder.path("a.ppm")).substr(15);
  const auto picture =
      Textures("").inside("a.jpg", {reinterpret_cast<const std::uint8_t*>(jpeg.data()), jpeg.size()});
  REQUIRE(picture != nullptr);
  // Of each square of 20 pixels the mean, as light.
  for (std::size_t cell = 0; cell < 8 * 6; ++cell) {
    const std::size_t left = 20 * (cell % 8);
    const std::size_t top = 20 * (cell / 8);
    const Texture::Sample sample =
        picture->average({(static_cast<double>(left) + 10) / 160, (static_cast<double>(top) + 10) / 120,
                          10.0 / 160, 10.0 / 120},
                         Wrap::kClamp, Wrap::kClamp);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      double light = 0;
      for (std::size_t i = 0; i < 400; ++i) {
        const std::size_t pixel = (top + i / 20) * 160 + left + i % 20;
        light += light_of(static_cast<std::uint8_t>(ppm[3 * pixel + channel])) / 400;
      }
      CHECK(std::abs(light - sample.light[channel]) < 0.02);
    }
  }
  check_refused(render + Words{folder.path("c.jpg"), "--background", "none"}, 2, {".png"});
}
