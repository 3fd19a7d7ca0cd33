// --engine gpu: the files of the core, on whatever Vulkan device there is; and what it does not draw.
#include <doctest/doctest.h>

#include "support/check_command.h"

namespace thimble::tests {
namespace {

bool command_has_device() {
  if (run_command({"--version"}).out.find("\nGPU            none") == std::string::npos) {
    return true;
  }
  MESSAGE("skipped: there is no Vulkan device");
  return false;
}

// Hits without the nodes, which count something else.
std::string without_nodes(const std::string& csv, std::size_t column) {
  std::string text;
  for (const std::string& line : lines_of(csv)) {
    Words columns = split(line);
    columns.at(column).clear();
    for (const std::string& one : columns) {
      text += one + ",";
    }
    text += "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("gpu command: render and trace -> the pictures and hits of ray64") {
  if (!command_has_device()) {
    return;
  }
  const TemporaryFolder folder;
  const std::string rays =
      folder.write("rays.csv", "1,2,3,300,-200,100\n-9,30,30,5,0,0\n70,70,70,-255,-255,-254\n");
  const std::vector<Words> scenes{{"castle", "--shade", "color"},
                                  {"castle", "--shade", "depth", "--projection", "orthographic"},
                                  {"spheres", "--shade", "normal"},
                                  {"points:3000", "--shade", "mono"}};
  for (const Words& scene : scenes) {
    CAPTURE(scene.back());
    for (const std::string engine : {"gpu", "ray64"}) {
      check_done(Words{"render"} + scene +
                 Words{"--engine", engine, "--size", "60x45", "--quiet", "-o", folder.path(engine + ".ppm"),
                       "--hits", folder.path(engine + ".csv"), "--stats", folder.path(engine + ".json")});
      check_done({"trace", scene.front(), "--engine", engine, "--rays", rays, "-o",
                  folder.path(engine + "_rays.csv")});
    }
    CHECK(read_text(folder.path("gpu.ppm")) == read_text(folder.path("ray64.ppm")));
    CHECK(without_nodes(read_text(folder.path("gpu.csv")), 8) ==
          without_nodes(read_text(folder.path("ray64.csv")), 8));
    CHECK(without_nodes(read_text(folder.path("gpu_rays.csv")), 6) ==
          without_nodes(read_text(folder.path("ray64_rays.csv")), 6));
    CHECK(read_text(folder.path("gpu.json")).find("\"gpu\"") != std::string::npos);
  }
}

TEST_CASE("gpu command: lit pictures, with their backgrounds, samples and parts -> the bytes of auto") {
  if (!command_has_device()) {
    return;
  }
  const TemporaryFolder folder;
  const std::vector<Words> pictures{{"castle"},
                                    {"fox", "--background", "none", "--projection", "orthographic"},
                                    {"oled", "--samples", "9", "--normals", "smooth"},
                                    {"spheres", "--ground", "off"},
                                    {"castle", "--effects", "direct-light,shadows,sky"},
                                    {"house", "--effects", "direct-light,shadows,emission,sky"}};
  for (const Words& picture : pictures) {
    CAPTURE(picture.front());
    for (const std::string engine : {"gpu", "auto"}) {
      check_done(Words{"render"} + picture +
                 Words{"--engine", engine, "--size", "60x45", "--quiet", "-o", folder.path(engine + ".png"),
                       "--stats", folder.path(engine + ".json")});
    }
    CHECK(read_text(folder.path("gpu.png")) == read_text(folder.path("auto.png")));
    CHECK(read_text(folder.path("gpu.json")).find("\"gpu\"") != std::string::npos);
  }
}

TEST_CASE("gpu command: what it does not draw -> status 2, a sentence, no file") {
  const TemporaryFolder folder;
  const std::vector<Words> refused{{"lagoon"},
                                   {"points:3000"},
                                   {"spheres", "--shade", "depth", "--samples", "4"},
                                   {"spheres", "--samples", "auto"},
                                   {"spheres", "--cutoff", "3"},
                                   {"spheres", "--memory", "8M"},
                                   {"spheres", "--board", "mps2-an500"},
                                   {"spheres", "--structure", "pool"},
                                   {"room"}};
  for (const Words& words : refused) {
    check_refused(Words{"render"} + words + Words{"--engine", "gpu", "-o", folder.path("p.ppm")}, 2, {});
  }
  CHECK(folder.names().empty());
  const std::string rays = folder.write("rays.csv", "1,2,3,300,-200,100\n");
  for (const Words& words : {Words{"--memory", "8M"}, Words{"--structure", "dense"}}) {
    check_refused(Words{"trace", "spheres", "--engine", "gpu", "--rays", rays} + words, 2, {});
  }
}

TEST_CASE("gpu command: where no Vulkan driver is -> status 1, a sentence; --version says so") {
  const TemporaryFolder folder;
  CommandLimits limits;
  limits.program = "/usr/bin/env";
  const Words without_driver{"VK_ICD_FILENAMES=" + folder.path("none.json"),
                             "VK_DRIVER_FILES=" + folder.path("none.json"), THIMBLE_COMMAND_PATH};
  CHECK(run_command(without_driver + Words{"--version"}, limits).out.find("\nGPU            none") !=
        std::string::npos);
  check_refused(without_driver + Words{"render", "spheres", "--shade", "depth", "--engine", "gpu", "-o",
                                       folder.path("p.ppm")},
                1, {}, limits);
  CHECK(folder.names().empty());
}

}  // namespace thimble::tests
