/* The C face as a C program sees it: C99, no C++ in sight. */
#include "c/face.h"

#include <string.h>

#include "thimble/thimble_c.h"

#define WIDTH 32
#define HEIGHT 24
#define WANT(condition) \
  do {                  \
    if (!(condition)) { \
      return __LINE__;  \
    }                   \
  } while (0)

/* C99's way to say that a handle is a whole number of words at a word's alignment. */
typedef char scene_is_words[sizeof(thimble_scene_t) == 8 * THIMBLE_WORDS_SCENE ? 1 : -1];
typedef char octree_is_words[sizeof(thimble_octree_t) == 8 * THIMBLE_WORDS_OCTREE ? 1 : -1];

static uint8_t pool[8 * 2000 + 8];
static uint8_t tree_bytes[4096];
static uint64_t world_words[2048];
static uint8_t journal_bytes[8 * 100];
static uint8_t frame_bytes[WIDTH * HEIGHT + WIDTH / 8 * HEIGHT];
static uint8_t picture[WIDTH * HEIGHT];

static int build(thimble_octree_t* octree) {
  const thimble_box_t floor_box = {{0, 0, 0}, {16, 16, 1}};
  int32_t z;
  WANT(thimble_octree_bytes(2000) <= sizeof pool);
  WANT(thimble_octree_make(octree, 4, pool, sizeof pool) == THIMBLE_OK);
  WANT(thimble_octree_insert_box(octree, &floor_box, 1) == THIMBLE_OK);
  for (z = 1; z < 9; ++z) {
    WANT(thimble_octree_insert(octree, 8, 8, z, 2) == THIMBLE_OK);
  }
  WANT(thimble_octree_contains(octree, 8, 8, 8) == 1);
  WANT(thimble_octree_contains(octree, 8, 8, 9) == 0);
  WANT(thimble_octree_material(octree, 3, 3, 0) == 1);
  return 0;
}

static int draw(const thimble_tree_t* tree, const thimble_camera_t* camera,
                const thimble_shading_t* shading) {
  thimble_band_t band = {0};
  band.pixels = picture;
  band.size_bytes = sizeof picture;
  band.format = THIMBLE_FORMAT_GRAY8;
  band.rows = HEIGHT;
  WANT(thimble_band_bytes(band.format, WIDTH, HEIGHT) == sizeof picture);
  memset(picture, 0x33, sizeof picture);
  WANT(thimble_tree_render(tree, camera, shading, &band) == THIMBLE_OK);
  return 0;
}

/* A world that is edited while it is drawn: what is under a pixel goes, a ball comes before it, and that is taken back. */
static int dig(const thimble_tree_t* tree, const thimble_camera_t* camera, const thimble_shading_t* shading) {
  thimble_world_t world;
  thimble_journal_t journal;
  thimble_tree_t now;
  thimble_bricks_t bricks;
  thimble_hit_t hit, before;
  thimble_box_t ball;
  static uint8_t fast[sizeof picture];
  size_t size = 0;
  thimble_band_t band = {0};
  band.pixels = fast;
  band.size_bytes = sizeof fast;
  band.format = THIMBLE_FORMAT_GRAY8;
  band.rows = HEIGHT;
  WANT(thimble_world_bytes(tree) != 0 && thimble_world_bytes(tree) < sizeof world_words);
  WANT(thimble_world_make(&world, tree, world_words, sizeof world_words) == THIMBLE_OK);
  WANT(thimble_journal_make(&journal, journal_bytes, sizeof journal_bytes) == THIMBLE_OK);
  WANT(thimble_tree_pick(tree, camera, WIDTH / 2, HEIGHT / 2, &before) == THIMBLE_OK);
  WANT(before.kind == THIMBLE_HIT && before.side == -1);
  WANT(thimble_world_material(&world, before.voxel.x, before.voxel.y, before.voxel.z) == before.material);
  WANT(thimble_world_put(&world, before.voxel.x, before.voxel.y, before.voxel.z, -1) == THIMBLE_OK);
  WANT(thimble_world_material(&world, before.voxel.x, before.voxel.y, before.voxel.z) == -1);
  WANT(thimble_world_tree(&world, &now) == THIMBLE_OK);
  WANT(thimble_tree_pick(&now, camera, WIDTH / 2, HEIGHT / 2, &hit) == THIMBLE_OK);
  WANT(hit.kind == THIMBLE_MISS);
  WANT(thimble_world_put(&world, before.voxel.x, before.voxel.y, before.voxel.z, 2) == THIMBLE_OK);

  ball.low = before.voxel;
  ball.low.y -= 5;
  ball.high.x = ball.low.x + 3;
  ball.high.y = ball.low.y + 3;
  ball.high.z = ball.low.z + 3;
  WANT(thimble_world_bricks(&world, &bricks) == THIMBLE_OK);
  WANT(thimble_world_edit(&world, &journal, &ball, THIMBLE_EDIT_BALL, 1) == THIMBLE_OK);
  WANT(thimble_world_material(&world, ball.low.x, ball.low.y, ball.low.z) == -1);
  WANT(thimble_world_material(&world, ball.low.x + 1, ball.low.y, ball.low.z + 1) == 1);
  WANT(thimble_world_tree(&world, &now) == THIMBLE_OK);
  WANT(thimble_tree_render_fast(&now, &bricks, camera, shading, &band) == THIMBLE_DAMAGED); /* of before */
  WANT(thimble_world_bricks(&world, &bricks) == THIMBLE_OK);
  WANT(thimble_tree_render_fast(&now, &bricks, camera, shading, &band) == THIMBLE_OK);
  WANT(draw(&now, camera, shading) == 0 && memcmp(fast, picture, sizeof picture) == 0);
  WANT(thimble_world_undo(&world, &journal) == THIMBLE_OK);
  WANT(thimble_world_undo(&world, &journal) == THIMBLE_BAD_ARGUMENT);
  WANT(thimble_world_edit(&world, &journal, &ball, THIMBLE_EDIT_BOX, 256) == THIMBLE_OUT_OF_RANGE);
  WANT(thimble_world_edit(&world, &journal, &ball, 2, 1) == THIMBLE_BAD_ARGUMENT);
  WANT(thimble_world_pack(&world, world_words, 0, &size) == THIMBLE_OUT_OF_MEMORY);
  WANT(size <= sizeof picture && thimble_world_pack(&world, fast, sizeof fast, &size) == THIMBLE_OK);
  WANT(memcmp(fast, tree_bytes, size) == 0);
  return 0;
}

int thimble_face_in_c(void) {
  static const uint8_t palette[] = {0, 0, 0, 90, 90, 90, 255, 255, 255};
  thimble_octree_t octree;
  thimble_octree_info_t info;
  thimble_tree_t tree;
  thimble_view_t view;
  thimble_camera_t camera;
  thimble_shading_t shading;
  thimble_ray_t ray;
  thimble_hit_t hit;
  thimble_frame_t frame;
  int line = build(&octree);
  WANT(line == 0);

  WANT(thimble_tree_bytes(&octree) <= sizeof tree_bytes);
  WANT(thimble_tree_make(&tree, &octree, tree_bytes, sizeof tree_bytes) == THIMBLE_OK);
  thimble_view_default(&view);
  view.eye_q8.x = 8 * 256 + 128;
  view.eye_q8.y = -24 * 256;
  view.eye_q8.z = 6 * 256;
  view.target_q8.x = view.eye_q8.x;
  view.target_q8.y = 8 * 256;
  view.target_q8.z = 6 * 256;
  view.fov_q16 = 30 << 16;
  WANT(thimble_camera_set(&camera, &view, WIDTH, HEIGHT, 4) == THIMBLE_OK);
  thimble_shading_default(&shading);
  shading.mode = THIMBLE_SHADE_COLOR;
  shading.palette_rgb = palette;
  shading.palette_colors = 3;
  line = draw(&tree, &camera, &shading);
  WANT(line == 0);
  WANT(picture[0] == 0);
  WANT(picture[WIDTH * (HEIGHT / 2) + WIDTH / 2] > 0);

  /* What is under the pixel in the middle: the mast, from the front. */
  WANT(thimble_camera_ray(&camera, WIDTH / 2, HEIGHT / 2, &ray) == THIMBLE_OK);
  WANT(thimble_tree_trace(&tree, &ray, UINT32_MAX, &hit) == THIMBLE_OK);
  WANT(hit.kind == THIMBLE_HIT && hit.material == 2 && hit.axis == 1 && hit.side == -1);
  WANT(hit.voxel.x == 8 && hit.voxel.y == 8);
  WANT(hit.point_q8.y == 8 * 256);
  WANT(hit.t_q32 == (int64_t)(((uint64_t)(uint32_t)hit.t_numerator << 32) / (uint32_t)hit.t_denominator));

  line = dig(&tree, &camera, &shading);
  WANT(line == 0);
  line = draw(&tree, &camera, &shading);
  WANT(line == 0);

  /* It is taken away, and a voxel put before it: the ray meets that. */
  WANT(thimble_octree_erase(&octree, hit.voxel.x, hit.voxel.y, hit.voxel.z) == THIMBLE_OK);
  WANT(thimble_octree_insert(&octree, hit.voxel.x, hit.voxel.y + hit.side, hit.voxel.z, 7) == THIMBLE_OK);
  WANT(thimble_octree_trace(&octree, &ray, UINT32_MAX, &hit) == THIMBLE_OK);
  WANT(hit.kind == THIMBLE_HIT && hit.material == 7 && hit.voxel.y == 7);
  WANT(thimble_octree_get_info(&octree, &info) == THIMBLE_OK);
  WANT(info.voxels == 256 + 8 && info.nodes + info.nodes_free >= 2000);

  WANT(thimble_frame_bytes(THIMBLE_FORMAT_GRAY8, WIDTH, HEIGHT) == sizeof frame_bytes);
  WANT(thimble_frame_make(&frame, &tree, &camera, &shading, THIMBLE_FORMAT_GRAY8, frame_bytes,
                          sizeof frame_bytes) == THIMBLE_OK);
  while (thimble_frame_inexact(&frame) != 0) {
    WANT(thimble_frame_refine(&frame, &tree, 5000) == THIMBLE_OK);
  }
  WANT(memcmp(frame_bytes, picture, sizeof picture) == 0);
  WANT(strcmp(thimble_status_text(THIMBLE_OUT_OF_MEMORY), "out of memory") == 0);
  return 0;
}
