// What the viewer writes and watches: names that are free, commands for a shell, files that change.
#include <doctest/doctest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "support/run_command.h"
#include "viewer/open_scene.h"
#include "viewer/saving.h"

namespace {

using namespace thimble::tools;
using namespace thimble::tools::viewer;
using thimble::tests::TemporaryFolder;

// A folder to be in for as long as this lives.
class Inside {
 public:
  explicit Inside(const std::string& folder) : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder);
  }
  ~Inside() { std::filesystem::current_path(before_); }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  std::filesystem::path before_;
};

}  // namespace

TEST_CASE("saving: names -> the scene's, the next free number, never one that is there") {
  const TemporaryFolder folder;
  const Inside inside(folder.path());
  CHECK(free_picture_name("models/castle.vox") == "castle.png");
  CHECK(free_picture_name("a/b.ply.gz") == "b.png");
  CHECK(free_picture_name("points:1000,seed=3") == "points-1000-seed-3.png");
  CHECK(free_picture_name("--help") == "help.png");
  CHECK(free_picture_name("/..") == "picture.png");
  CHECK(free_picture_name(std::string(300, 'a')).size() <= 255);
  const std::vector<std::uint8_t> rgb(3 * 4 * 2, 77);
  CHECK(save_picture("castle.vox", 4, 2, rgb) == "castle.png");
  const std::string first = thimble::tests::read_text("castle.png");
  std::filesystem::create_symlink("nowhere", "castle-2.png");  // taken too
  CHECK(save_picture("castle.vox", 4, 2, std::vector<std::uint8_t>(24, 1)) == "castle-3.png");
  CHECK(thimble::tests::read_text("castle.png") == first);
  CHECK(folder.names().size() == 3);
}

TEST_CASE("saving: a folder that cannot be written -> a sentence, and nothing is left") {
  if (::geteuid() == 0) {
    return;  // may write anywhere
  }
  const TemporaryFolder folder;
  const Inside inside(folder.path());
  std::filesystem::permissions(folder.path(),
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  CHECK_THROWS(save_picture("castle.vox", 1, 1, {1, 2, 3}));
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
  CHECK(folder.names().empty());
}

TEST_CASE("saving: the command -> only what is not the default, quoted where a shell wants it") {
  SceneArguments scene;
  scene.scene = "it's a castle.vox";
  scene.depth = 7;
  ViewWishes view;
  view.width_px = 640;
  view.height_px = 480;
  view.side = NamedView::kBest;
  CHECK(render_command(scene, view, {}, "a.png") ==
        "thimble render 'it'\\''s a castle.vox' --depth 7 --size 640x480 -o a.png");
  scene.frame = 3;
  CHECK(render_command(scene, view, {}, "a.png") ==
        "thimble render 'it'\\''s a castle.vox' --depth 7 --frame 3 --size 640x480 -o a.png");
  view.placed = true;
  view.eye = {-1.5, 2, 1.0 / 8};
  view.target = {0, 0, 0};
  view.fov_degrees = 35;
  SceneArguments upright;
  upright.scene = "x.ply";
  upright.z_up = true;
  CHECK(render_command(upright, view, {"--samples", "4"}, "b.png") ==
        "thimble render x.ply --z-up --size 640x480 --eye -1.5,2,0.125 --target 0,0,0 --fov 35 --samples 4 "
        "-o b.png");
  SceneArguments array;
  array.scene = "x.npz";
  array.as_points = array.as_heights = array.as_voxels = true;
  array.full_color = 65535;
  array.fit_percent = 99.5;
  array.clip = {-1, 0, 0.5, 1, 2, 3};
  CHECK(render_command(array, {}, {}, "c.png").substr(21) ==
        "--as-voxels --as-points --as-heights --colors 65535 --fit 99.5 --clip -1,0,0.5,1,2,3 --size 800x600 "
        "--view paper -o c.png");
  CHECK(quoted_for_shell("") == "''");
  CHECK(quoted_for_shell("$(rm)") == "'$(rm)'");
}

TEST_CASE("file watch: changed and then still -> once; while it is written, gone, or no file -> not") {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.vox", "one");
  FileWatch watch(path);
  double time = 0;
  const auto changed = [&] { return watch.has_changed(time += 0.3); };
  CHECK_FALSE(changed());
  folder.write("a.vox", "longer");
  CHECK_FALSE(changed());  // it may still be written
  folder.write("a.vox", "longer still");
  CHECK_FALSE(changed());
  CHECK(changed());
  CHECK_FALSE(changed());
  std::filesystem::remove(path);
  CHECK_FALSE(changed());
  CHECK_FALSE(changed());
  folder.write("a.vox", "again");
  CHECK_FALSE(changed());
  CHECK(changed());
  CHECK_FALSE(watch.has_changed(time + 0.01));  // too soon to look
  // Several: any of them counts, once all rest and none is gone.
  const std::string other = folder.path("b.vox");
  watch.watch({path, other});  // not there yet
  CHECK_FALSE(changed());
  folder.write("b.vox", "new");
  CHECK_FALSE(changed());
  CHECK(changed());
  folder.write("b.vox", "newer");
  std::filesystem::remove(path);
  CHECK_FALSE(changed());
  CHECK_FALSE(changed());
  folder.write("a.vox", "back");
  CHECK_FALSE(changed());
  CHECK(changed());
  folder.write("b.vox", "changed between");
  watch.watch({other});  // what was known of it stays known
  CHECK_FALSE(changed());
  CHECK(changed());
  folder.write("a.vox", "no longer watched");
  CHECK_FALSE(changed());
  CHECK_FALSE(changed());
  FileWatch none("points:1000");
  CHECK_FALSE(none.has_changed(1));
  CHECK_FALSE(none.has_changed(2));
}
