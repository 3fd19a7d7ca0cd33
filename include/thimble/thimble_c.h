/// @file thimble_c.h
/// The core for C (C99), and for what calls C: LVGL, MicroPython, Rust, firmware. C++ may include it, too.
///
///     thimble_scene_t scene;
///     int32_t status = thimble_scene_open(&scene, bytes, sizeof bytes);  // in flash, used where they lie
///
/// What holds everywhere
///   - A function that can fail returns a status, 0 (THIMBLE_OK) or a positive number of `enum
///     thimble_status`. Unless it is THIMBLE_OK, nothing has changed.
///   - Arguments may be anything: a null pointer, a handle that holds nothing, a number that no enum has, a
///     negative size are THIMBLE_BAD_ARGUMENT, or the answer that the function states; never more. What
///     cannot be checked is left to the caller: a pointer that is not null points to what it says, bytes are
///     as many as their size says, and no two arguments overlap.
///   - No function allocates or keeps anything. A handle (`thimble_scene_t`, ...) is plain bytes of a fixed
///     size that you put where you like, on the stack too; it needs no clean-up. All bytes 0, it holds
///     nothing. What it was made of (flash, a pool) stays where it is for as long as the handle is used.
///     Copies are made by assignment, and share those bytes: of an octree, a world, a journal, a frame or
///     particles use one of them only.
///   - Reentrant: two calls may run at a time, on an interrupt or a second core, as long as neither writes
///     what the other uses.
///   - Numbers: `_q8` counts 1/256, `_q14` 1/16384, `_q16` 1/65536, `_q32` 2^-32. Lengths are in voxels.
///     Worlds are cubes of 2^level voxels a side, level 1 .. 12, z up; image right = forward x up; row 0 is
///     on top.
///
/// Stack of the calls: tests/budgets/stack.csv. Flash of whole programs: tests/budgets/c_programs.csv. What
/// is not called takes none, where the core is compiled with -ffunction-sections and linked with
/// --gc-sections.
#ifndef THIMBLE_THIMBLE_C_H
#define THIMBLE_THIMBLE_C_H

#if defined(__AVR__)
#error "AVR is not supported: int has 16 bits. Thimble needs a chip of 32 bits."
#elif defined(__SIZEOF_INT__) && __SIZEOF_INT__ < 4
#error "This processor is not supported: int has 16 bits. Thimble needs one of 32 bits."
#endif

#include <stddef.h>
#include <stdint.h>

/// Handles are written by the core as what they hold, and copied by C as numbers: compilers that optimise
/// across both languages must know.
#ifdef __GNUC__
#define THIMBLE_HANDLE __attribute__((__may_alias__))
#else
#define THIMBLE_HANDLE
#endif

#ifdef __cplusplus
extern "C" {
#endif

// --- Status, versions ------------------------------------------------------------------------------------

enum thimble_status {
  THIMBLE_OK = 0,
  THIMBLE_OUT_OF_MEMORY = 1,  ///< the bytes given do not hold the result
  THIMBLE_OUT_OF_RANGE = 2,   ///< a number lies beyond a stated limit
  THIMBLE_BAD_ARGUMENT = 3,   ///< null, an empty handle, arguments that contradict themselves
  THIMBLE_TOO_FINE = 4,       ///< a picture so fine that its rays could not be kept within 1/8 pixel
  THIMBLE_DAMAGED = 5,        ///< bytes that are not what they should be, or of another version
  THIMBLE_STEP_LIMIT = 6      ///< a ray was stopped by the step limit before its answer was known
};

/// A short English phrase, for example "out of memory"; "unknown status" for other numbers. Never null. The
/// phrases are in the image only where this is called.
const char* thimble_status_text(int32_t status);

/// The version of baked scenes that is read; any other is refused.
enum thimble_versions { THIMBLE_BAKED_VERSION = 1 };

// --- Handles ---------------------------------------------------------------------------------------------

/// Sizes of the handles in words of 8 bytes: exact for pointers of 4 and of 8 bytes on ARM, RISC-V, x86-64
/// and whatever else aligns uint64_t to 8; an upper bound elsewhere. The core does not compile where one is
/// too small.
enum thimble_sizes {
  THIMBLE_WORDS_SCENE = sizeof(void*) > 4 ? 27 : 20,
  THIMBLE_WORDS_TREE = sizeof(void*) > 4 ? 14 : 9,
  THIMBLE_WORDS_OCTREE = sizeof(void*) > 4 ? 19 : 18,
  THIMBLE_WORDS_CAMERA = 16,
  THIMBLE_WORDS_BRICKS = sizeof(void*) > 4 ? 12 : 9,
  THIMBLE_WORDS_LIGHT = sizeof(void*) > 4 ? 19 : 14,
  THIMBLE_WORDS_FRAME = sizeof(void*) > 4 ? 37 : 33,
  THIMBLE_WORDS_PARTICLES = sizeof(void*) > 4 ? 33 : 29,
  THIMBLE_WORDS_WORLD = sizeof(void*) > 4 ? 42 : 29,
  THIMBLE_WORDS_JOURNAL = sizeof(void*) > 4 ? 4 : 2
};

/// A baked scene. Made by thimble_scene_open.
typedef struct THIMBLE_HANDLE thimble_scene {
  uint64_t opaque[THIMBLE_WORDS_SCENE];
} thimble_scene_t;
/// A compact tree, read-only. Made by thimble_tree_make, thimble_tree_open, thimble_scene_tree,
/// thimble_world_tree.
typedef struct THIMBLE_HANDLE thimble_tree {
  uint64_t opaque[THIMBLE_WORDS_TREE];
} thimble_tree_t;
/// An octree that changes. Made by thimble_octree_make.
typedef struct THIMBLE_HANDLE thimble_octree {
  uint64_t opaque[THIMBLE_WORDS_OCTREE];
} thimble_octree_t;
/// A camera for pictures of one size in worlds of one level. Made by thimble_camera_set,
/// thimble_scene_camera.
typedef struct THIMBLE_HANDLE thimble_camera {
  uint64_t opaque[THIMBLE_WORDS_CAMERA];
} thimble_camera_t;
/// The brick map of a scene or a world. Made by thimble_scene_bricks, thimble_world_bricks.
typedef struct THIMBLE_HANDLE thimble_bricks {
  uint64_t opaque[THIMBLE_WORDS_BRICKS];
} thimble_bricks_t;
/// The light of a baked scene. Made by thimble_scene_light.
typedef struct THIMBLE_HANDLE thimble_light {
  uint64_t opaque[THIMBLE_WORDS_LIGHT];
} thimble_light_t;
/// A picture that is refined until there is no more time. Made by thimble_frame_make.
typedef struct THIMBLE_HANDLE thimble_frame {
  uint64_t opaque[THIMBLE_WORDS_FRAME];
} thimble_frame_t;
/// Balls in a field of bits. Made by thimble_particles_make.
typedef struct THIMBLE_HANDLE thimble_particles {
  uint64_t opaque[THIMBLE_WORDS_PARTICLES];
} thimble_particles_t;
/// A compact tree and its brick map that change. Made by thimble_world_make.
typedef struct THIMBLE_HANDLE thimble_world {
  uint64_t opaque[THIMBLE_WORDS_WORLD];
} thimble_world_t;
/// What edits of a world changed, to take it back. Made by thimble_journal_make.
typedef struct THIMBLE_HANDLE thimble_journal {
  uint64_t opaque[THIMBLE_WORDS_JOURNAL];
} thimble_journal_t;

// --- Plain data ------------------------------------------------------------------------------------------

typedef struct thimble_vec3 {
  int32_t x;
  int32_t y;
  int32_t z;
} thimble_vec3_t;

/// The voxels low .. high - 1 on every axis; empty where low >= high on any.
typedef struct thimble_box {
  thimble_vec3_t low;
  thimble_vec3_t high;
} thimble_box_t;

/// The points origin_q8 / 256 + t * direction, t >= 0.
typedef struct thimble_ray {
  thimble_vec3_t origin_q8;  ///< -4 .. 5 world sizes on every axis
  thimble_vec3_t direction;  ///< integers of at most 20 bits and a sign, not all 0
} thimble_ray_t;

enum thimble_hit_kind {
  THIMBLE_MISS = 0,    ///< the ray leaves the world without a hit; only `visits` means something
  THIMBLE_HIT = 1,     ///< everything is valid
  THIMBLE_STOPPED = 2  ///< by the limit of visits; only `visits` means something
};

/// What a ray met first. The core is exact: t is a fraction, and the other forms follow from it.
typedef struct thimble_hit {
  int32_t kind;           ///< enum thimble_hit_kind
  thimble_vec3_t voxel;   ///< its indices
  int32_t axis;           ///< of the face entered: 0, 1, 2, the lowest at an edge; -1: the ray starts inside
  int32_t side;           ///< the face looks to larger (1) or smaller (-1) coordinates; 0 for axis -1. The
                          ///< empty voxel before the face is `voxel` with `side` added on `axis`
  int32_t material;       ///< palette index, 0 .. 255
  int32_t block_level;    ///< 0; above it, the block of 2^block_level voxels a side that coarsening merged
  int32_t t_numerator;    ///< t = t_numerator / t_denominator exactly: 0 .. 2^23 ...
  int32_t t_denominator;  ///< ... and 256 * |direction on axis|, or 1 for axis -1
  int64_t t_q32;          ///< t in fixed point, rounded down
  thimble_vec3_t point_q8;  ///< where: on the face exactly, within it rounded down to 1/256 voxel
  uint32_t visits;          ///< nodes that were read
} thimble_hit_t;

enum thimble_projection { THIMBLE_PERSPECTIVE = 0, THIMBLE_ORTHOGRAPHIC = 1 };

/// From where a picture is taken. Begin with thimble_view_default or thimble_scene_view.
typedef struct thimble_view {
  int32_t projection;        ///< enum thimble_projection
  int32_t direction_bits;    ///< of the rays: 0 for as many as the picture needs, or 8 .. 20
  thimble_vec3_t eye_q8;     ///< -4 .. 5 world sizes on every axis
  thimble_vec3_t target_q8;  ///< what is looked at; anywhere but at the eye
  thimble_vec3_t forward;    ///< where it looks, up to 2^30 a component; all 0: from eye to target. Whoever
                             ///< moves the eye of a stored view clears it
  thimble_vec3_t up;         ///< not parallel to that; all 0: z, or y for who looks along z
  int32_t fov_q16;           ///< perspective: vertical angle in degrees, 1 .. 120
  int32_t span_q14;          ///< orthographic: width of the picture in voxels, above 0
} thimble_view_t;

enum thimble_shade {
  THIMBLE_SHADE_DEPTH = 0,   ///< brightness falls with the distance
  THIMBLE_SHADE_NORMAL = 1,  ///< the direction of the face as a colour
  THIMBLE_SHADE_COLOR = 2,   ///< palette colour by `face_light`
  THIMBLE_SHADE_MONO = 3     ///< white where something is, black where not
};

/// From a hit to a colour. Begin with thimble_shading_default or thimble_scene_shading.
typedef struct thimble_shading {
  const uint8_t* palette_rgb;  ///< r, g, b a material; may be null where palette_colors is 0
  uint32_t palette_colors;     ///< materials beyond it have `default_rgb`
  int32_t mode;                ///< enum thimble_shade; a lit picture does not look at it
  int32_t near_q8;             ///< THIMBLE_SHADE_DEPTH: the distance along the view that is brightest ...
  int32_t far_q8;              ///< ... and the one that is dimmest
  uint16_t face_light[6];      ///< brightness of the faces -x, +x, -y, +y, -z, +z; 256 is the palette's own
  uint8_t default_rgb[3];
  uint8_t background_rgb[3];  ///< where a ray hits nothing
} thimble_shading_t;

/// Pixel formats, as `thimble::PixelFormat` in thimble/picture/pixel.h describes them. A core compiled with
/// THIMBLE_PANEL_FORMATS knows of those behind RGB888 only what that names; the others are unknown to it.
enum thimble_format {
  THIMBLE_FORMAT_MONO1 = 0,        ///< 1 bit, the leftmost pixel in the highest, 1 = lit; dithered
  THIMBLE_FORMAT_GRAY4 = 1,        ///< 4 bits, the left pixel in the high nibble, 15 = white
  THIMBLE_FORMAT_GRAY8 = 2,        ///< 1 byte, 255 = white
  THIMBLE_FORMAT_RGB565 = 3,       ///< 2 bytes, little-endian: rrrrrggg gggbbbbb
  THIMBLE_FORMAT_RGB888 = 4,       ///< 3 bytes: r, g, b
  THIMBLE_FORMAT_RGB565_BE = 5,    ///< RGB565, big-endian: ST7735, ST7789, ILI9341
  THIMBLE_FORMAT_BGR565 = 6,       ///< 2 bytes, little-endian: bbbbbggg gggrrrrr
  THIMBLE_FORMAT_RGB444 = 7,       ///< two pixels in 3 bytes: rrrrgggg bbbbrrrr ggggbbbb
  THIMBLE_FORMAT_MONO1_PAGES = 8,  ///< pages of 8 rows, a byte a column, the topmost lowest: SSD1306
  THIMBLE_FORMAT_GRAY4_LOW = 9,    ///< GRAY4 with the left pixel in the low nibble
  THIMBLE_FORMAT_GRAY2 = 10,       ///< 2 bits, the leftmost pixel in the highest two, 3 = white; dithered
  THIMBLE_FORMAT_PAPER3 = 11,      ///< e-paper in black, white and red: a byte of white, one of red
  THIMBLE_FORMAT_PAPER7 = 12,      ///< e-paper in 7 colours, 4 bits, the left pixel in the high nibble
  THIMBLE_FORMAT_RGB332 = 13       ///< 1 byte: rrrgggbb
};

/// Rows first_row .. first_row + rows - 1 of a picture, and the bytes that they go to.
typedef struct thimble_band {
  uint8_t* pixels;      ///< the first of these rows stands at its front
  size_t size_bytes;    ///< at least thimble_band_bytes(format, width, rows), or as the stride says
  size_t stride_bytes;  ///< from one row to the next; 0: rows without gaps
  int32_t format;       ///< enum thimble_format
  int32_t first_row;    ///< a multiple of thimble_band_row_multiple(format)
  int32_t rows;         ///< a multiple as well, unless the picture ends with the band; 0 draws nothing
} thimble_band_t;

/// Bytes for `rows` rows of `width_px` pixels without gaps, both 0 .. 16384; 0 beyond that and for an unknown
/// format.
size_t thimble_band_bytes(int32_t format, int32_t width_px, int32_t rows);
/// Rows that the format keeps together, 1 for most; 0 for an unknown format.
int32_t thimble_band_row_multiple(int32_t format);

// --- Cameras and shading ---------------------------------------------------------------------------------

/// A perspective view of 60 degrees with the eye at 0, looking along y. Null: nothing.
void thimble_view_default(thimble_view_t* view);

/// Sets the camera up for a picture of width_px x height_px, each 1 .. 16384, in a world of 2^level. Cost:
/// some thousand instructions, integers only. THIMBLE_BAD_ARGUMENT: null, projection, no pixels, nothing to
/// look at, `up` along the view, no span. THIMBLE_OUT_OF_RANGE: level, size, angle, bits, a vector, the
/// eye. THIMBLE_TOO_FINE: see there.
int32_t thimble_camera_set(thimble_camera_t* camera, const thimble_view_t* view, int32_t width_px,
                           int32_t height_px, int32_t level);

/// The picture's size. THIMBLE_BAD_ARGUMENT: null or not set.
int32_t thimble_camera_size(const thimble_camera_t* camera, int32_t* width_px, int32_t* height_px);
/// The ray through the centre of pixel (px, py): what thimble_tree_trace and its like take to say what is
/// under a pixel. THIMBLE_BAD_ARGUMENT: null or not set; THIMBLE_OUT_OF_RANGE: outside the picture.
int32_t thimble_camera_ray(const thimble_camera_t* camera, int32_t px, int32_t py, thimble_ray_t* ray);

/// Depth shading from 0 to 1 voxel without a palette, light grey on black, lit from above. Null: nothing.
void thimble_shading_default(thimble_shading_t* shading);
/// Sets `near_q8` and `far_q8` so that they just hold `box` as the camera sees it. Corners 0 .. 4096.
/// THIMBLE_BAD_ARGUMENT: null or not set; THIMBLE_OUT_OF_RANGE: a corner.
int32_t thimble_shading_planes(thimble_shading_t* shading, const thimble_camera_t* camera,
                               const thimble_box_t* box);
/// Sets `face_light` to a distant light from (x, y, z): components up to 2^14, not all 0.
/// THIMBLE_BAD_ARGUMENT: null, all 0; THIMBLE_OUT_OF_RANGE: a component.
int32_t thimble_shading_light(thimble_shading_t* shading, int32_t x, int32_t y, int32_t z);

// --- Baked scenes ----------------------------------------------------------------------------------------

/// Opens a scene that `thimble bake` wrote, where it lies: at any address, in flash or not. Reads the
/// header, not the tree: the cost does not grow with the scene. A scene that opens is safe to draw,
/// whatever its bytes say. THIMBLE_BAD_ARGUMENT: null; THIMBLE_DAMAGED: no scene, or one of another
/// version.
int32_t thimble_scene_open(thimble_scene_t* scene, const void* bytes, size_t size_bytes);
/// Reads every byte once, the CRC-32 among them. Null for a sound scene, else a phrase that says what is
/// wrong; `place` (may be null) gets the offset, or the number of the tree's node.
const char* thimble_scene_validate(const void* bytes, size_t size_bytes, uint32_t* place);

/// What a tree is.
typedef struct thimble_tree_info {
  uint64_t voxels;       ///< solid volume, merged blocks included
  uint64_t solid_added;  ///< of these, added by coarsening
  const uint8_t* bytes;  ///< where it lies, for whoever writes it to flash or a file
  size_t size_bytes;
  thimble_box_t bounds;  ///< the least box that holds everything solid
  int32_t level;
  uint32_t nodes;
} thimble_tree_info_t;

/// What a scene is.
typedef struct thimble_scene_info {
  thimble_tree_info_t tree;
  const uint8_t* palette_rgb;  ///< r, g, b a material; null where there is none
  uint32_t palette_colors;     ///< 0 .. 256
  uint32_t crc32;              ///< as its header states it
  const char* name;            ///< UTF-8 without a final zero; null where there is none
  uint32_t name_bytes;         ///< 0 .. 255
  int32_t has_view;            ///< 1 or 0: thimble_scene_view
  int32_t has_light;           ///< 1 or 0: thimble_scene_light
  int32_t has_bricks;          ///< 1 or 0: thimble_scene_bricks
} thimble_scene_info_t;

/// Constant time. THIMBLE_BAD_ARGUMENT: null or not open.
int32_t thimble_scene_get_info(const thimble_scene_t* scene, thimble_scene_info_t* info);
/// The scene's tree, for thimble_tree_trace and its like. THIMBLE_BAD_ARGUMENT: null or not open.
int32_t thimble_scene_tree(const thimble_scene_t* scene, thimble_tree_t* tree);
/// The view that is stored. THIMBLE_BAD_ARGUMENT: null, not open, or there is none.
int32_t thimble_scene_view(const thimble_scene_t* scene, thimble_view_t* view);
/// thimble_camera_set with the scene's level; `view` null: the one that is stored.
int32_t thimble_scene_camera(const thimble_scene_t* scene, const thimble_view_t* view, int32_t width_px,
                             int32_t height_px, thimble_camera_t* camera);
/// thimble_shading_default with the scene's palette and THIMBLE_SHADE_COLOR. THIMBLE_BAD_ARGUMENT: null or
/// not open.
int32_t thimble_scene_shading(const thimble_scene_t* scene, thimble_shading_t* shading);

/// Draws a band. Each pixel is a function of scene, camera and shading alone: bands of any height, in any
/// order, make the same picture. Cost: a ray a pixel, some thousand instructions each.
/// THIMBLE_BAD_ARGUMENT: null, not set, a camera for another level, an unknown format or mode, rows outside
/// the picture, a stride below a row; THIMBLE_OUT_OF_MEMORY: `size_bytes`.
int32_t thimble_scene_render(const thimble_scene_t* scene, const thimble_camera_t* camera,
                             const thimble_shading_t* shading, const thimble_band_t* band);

/// What a ray meets first. `max_visits`: the ray is stopped (THIMBLE_STOPPED) instead of reading one node
/// more; UINT32_MAX: never, each ray ends by itself. Cost: a few hundred to some thousand instructions.
/// THIMBLE_BAD_ARGUMENT: null, not open, a direction of all 0; THIMBLE_OUT_OF_RANGE: origin or direction.
int32_t thimble_scene_trace(const thimble_scene_t* scene, const thimble_ray_t* ray, uint32_t max_visits,
                            thimble_hit_t* hit);
/// What is under pixel (px, py) of the camera's picture: thimble_camera_ray and thimble_scene_trace, and
/// their errors; THIMBLE_BAD_ARGUMENT also for a camera of another level.
int32_t thimble_scene_pick(const thimble_scene_t* scene, const thimble_camera_t* camera, int32_t px,
                           int32_t py, thimble_hit_t* hit);

/// The scene's brick map, which makes frames on a chip 13 times as fast. `thimble bake` stores one where the
/// bytes suffice, and it wants the scene's bytes at a multiple of 8. THIMBLE_BAD_ARGUMENT: null, not open,
/// address; THIMBLE_DAMAGED: none, or damaged. Cost: ten instructions a brick of the world's box.
int32_t thimble_scene_bricks(const thimble_scene_t* scene, thimble_bricks_t* bricks);
/// thimble_scene_render by the scene's brick map: the same picture. On a Cortex-M0 it takes 55 KB of flash
/// and 4.4 KB of stack more. THIMBLE_DAMAGED: the map is another scene's.
int32_t thimble_scene_render_fast(const thimble_scene_t* scene, const thimble_bricks_t* bricks,
                                  const thimble_camera_t* camera, const thimble_shading_t* shading,
                                  const thimble_band_t* band);

// --- Light -----------------------------------------------------------------------------------------------

/// Effects, as bits of a set.
enum thimble_effects {
  THIMBLE_EFFECT_DIRECT_LIGHT = 0x0001,
  THIMBLE_EFFECT_SHADOWS = 0x0002,
  THIMBLE_EFFECT_AMBIENT_OCCLUSION = 0x0004,
  THIMBLE_EFFECT_EMISSION = 0x0008,
  THIMBLE_EFFECT_MIRROR = 0x0010,
  THIMBLE_EFFECT_GLASS = 0x0020,
  THIMBLE_EFFECT_MEDIA = 0x0040,
  THIMBLE_EFFECT_WATER = 0x0080,
  THIMBLE_EFFECT_FOG = 0x0100,
  THIMBLE_EFFECT_SKY = 0x0200,
  THIMBLE_EFFECT_DEPTH_CUE = 0x0400,
  THIMBLE_EFFECT_SMOOTH_NORMALS = 0x0800,
  THIMBLE_EFFECT_EMITTER_LIGHT = 0x1000,
  THIMBLE_EFFECT_EDGES = 0x2000,
  THIMBLE_EFFECT_RIPPLES = 0x4000
};
/// "shadows", "ambient-occlusion", ...; "" for anything but one effect. Never null.
const char* thimble_effect_name(uint32_t effect);

/// A light of a scene.
typedef struct thimble_lamp {
  int32_t is_point;      ///< 1: a point; 0: distant, as the sun is
  thimble_vec3_t place;  ///< a point's place in 1/256 voxel; else where the light comes from, any length
  uint16_t color_q8[3];  ///< 256: what makes white white
  uint16_t reach;        ///< a point's: voxels until a quarter is left
} thimble_lamp_t;

/// Opens the light of a scene: surfaces, lights, sky, fog, water. THIMBLE_BAD_ARGUMENT: null or not open;
/// THIMBLE_DAMAGED: none, or damaged. Cost: at most 256 surfaces and 100 lights are looked at.
int32_t thimble_scene_light(const thimble_scene_t* scene, thimble_light_t* light);
/// The effects that the scene was baked for, a set; 0 where the handle is null or holds nothing.
uint32_t thimble_light_effects(const thimble_light_t* light);
/// Lights there are, 0 .. 100; 0 where the handle is null or holds nothing.
uint32_t thimble_light_lamps(const thimble_light_t* light);
/// Light `index`. THIMBLE_BAD_ARGUMENT: null or nothing held; THIMBLE_OUT_OF_RANGE: index.
int32_t thimble_light_lamp(const thimble_light_t* light, uint32_t index, thimble_lamp_t* lamp);

/// Draws a band with exactly `effects`; thimble_light_effects gives those that the scene was baked for, 0
/// is thimble_scene_render. Errors as there; bits that are no effect are passed over.
///
/// A program that calls this holds the code of every effect (86 KB on a Cortex-M0). One that draws scenes
/// of a known set compiles src/c/light_render.cpp with THIMBLE_C_EFFECTS=SET (in CMake:
/// target_compile_definitions(thimble PRIVATE THIMBLE_C_EFFECTS=0x3); SET is THIMBLE_SCENE_EFFECTS in the
/// header that `thimble bake` writes) and then holds the code of these alone (25 KB for 0x3). It draws SET,
/// and what lacks of SET only effects that trace no ray of their own (direct light, emission, fog, sky,
/// depth cue, smooth normals, emitter light), but not 0; THIMBLE_OUT_OF_RANGE for other sets. A program
/// that does not call this holds no light at all.
int32_t thimble_scene_render_lit(const thimble_scene_t* scene, const thimble_light_t* light, uint32_t effects,
                                 const thimble_camera_t* camera, const thimble_shading_t* shading,
                                 const thimble_band_t* band);

// --- An octree that changes ------------------------------------------------------------------------------

/// Bytes of a pool of so many nodes; SIZE_MAX where size_t cannot say it. A ball of 20 voxels across takes
/// 700.
size_t thimble_octree_bytes(uint32_t nodes);
/// An empty world of 2^level voxels a side, level 1 .. 12, with as many nodes as `bytes` (any address) holds.
/// Constant time. THIMBLE_BAD_ARGUMENT: null; THIMBLE_OUT_OF_RANGE: level.
int32_t thimble_octree_make(thimble_octree_t* octree, int32_t level, void* bytes, size_t size_bytes);
/// Empties it. THIMBLE_BAD_ARGUMENT: null or not made.
int32_t thimble_octree_clear(thimble_octree_t* octree);
/// Whether a full pool is coarsened (`yes` not 0) instead of refused: blocks that add the least solid volume
/// are merged. THIMBLE_BAD_ARGUMENT: null or not made.
int32_t thimble_octree_set_coarsen(thimble_octree_t* octree, int32_t yes);
/// Makes a voxel solid, of material 0 .. 255. At most 96 new nodes; nearby voxels one after the other are
/// fastest. THIMBLE_BAD_ARGUMENT: null or not made; THIMBLE_OUT_OF_RANGE: outside the world, material;
/// THIMBLE_OUT_OF_MEMORY: no room.
int32_t thimble_octree_insert(thimble_octree_t* octree, int32_t x, int32_t y, int32_t z, int32_t material);
/// Makes the voxels of a box within the world solid. Errors as above; with THIMBLE_OUT_OF_MEMORY a part of
/// the box may be there, and the call can be repeated. Cost: about the box's surface.
int32_t thimble_octree_insert_box(thimble_octree_t* octree, const thimble_box_t* box, int32_t material);
/// Makes a voxel empty. Errors as thimble_octree_insert: a hole in a solid block takes nodes, too.
int32_t thimble_octree_erase(thimble_octree_t* octree, int32_t x, int32_t y, int32_t z);
/// 1 where the voxel is solid; 0 where it is not, outside the world, and where the handle holds nothing.
int32_t thimble_octree_contains(const thimble_octree_t* octree, int32_t x, int32_t y, int32_t z);
/// The voxel's material; -1 where thimble_octree_contains is 0.
int32_t thimble_octree_material(const thimble_octree_t* octree, int32_t x, int32_t y, int32_t z);

typedef struct thimble_octree_info {
  uint64_t voxels;       ///< solid volume
  uint64_t solid_added;  ///< voxels that coarsening added since it was made or cleared
  thimble_box_t bounds;  ///< holds everything solid
  int32_t level;
  uint32_t nodes;             ///< in use
  uint32_t nodes_free;        ///< room left, of 8 bytes each
  uint32_t nodes_high_water;  ///< the most that were in use
} thimble_octree_info_t;
/// Constant time. THIMBLE_BAD_ARGUMENT: null or not made.
int32_t thimble_octree_get_info(const thimble_octree_t* octree, thimble_octree_info_t* info);

/// As the functions of a scene, and their errors.
int32_t thimble_octree_render(const thimble_octree_t* octree, const thimble_camera_t* camera,
                              const thimble_shading_t* shading, const thimble_band_t* band);
int32_t thimble_octree_trace(const thimble_octree_t* octree, const thimble_ray_t* ray, uint32_t max_visits,
                             thimble_hit_t* hit);

// --- Compact trees ---------------------------------------------------------------------------------------

/// Bytes of the compact tree of an octree as it is now; 0 where the handle holds nothing or it would take
/// more than 2^32 - 1. Cost: one pass.
size_t thimble_tree_bytes(const thimble_octree_t* octree);
/// Writes the compact tree of an octree to the front of `bytes` (any address): smaller, read-only, faster.
/// Cost: level + 1 passes. THIMBLE_BAD_ARGUMENT: null or not made; THIMBLE_OUT_OF_MEMORY: size_bytes below
/// thimble_tree_bytes.
int32_t thimble_tree_make(thimble_tree_t* tree, const thimble_octree_t* octree, void* bytes,
                          size_t size_bytes);
/// Opens a tree where it lies. Constant time. THIMBLE_BAD_ARGUMENT: null; THIMBLE_DAMAGED: no tree, or one of
/// another version.
int32_t thimble_tree_open(thimble_tree_t* tree, const void* bytes, size_t size_bytes);
/// Constant time. THIMBLE_BAD_ARGUMENT: null or not open.
int32_t thimble_tree_get_info(const thimble_tree_t* tree, thimble_tree_info_t* info);
/// As the functions of a scene, and their errors.
int32_t thimble_tree_render(const thimble_tree_t* tree, const thimble_camera_t* camera,
                            const thimble_shading_t* shading, const thimble_band_t* band);
int32_t thimble_tree_trace(const thimble_tree_t* tree, const thimble_ray_t* ray, uint32_t max_visits,
                           thimble_hit_t* hit);
int32_t thimble_tree_pick(const thimble_tree_t* tree, const thimble_camera_t* camera, int32_t px, int32_t py,
                          thimble_hit_t* hit);
/// As thimble_scene_render_fast. THIMBLE_DAMAGED: the map is another tree's, or of before an edit.
int32_t thimble_tree_render_fast(const thimble_tree_t* tree, const thimble_bricks_t* bricks,
                                 const thimble_camera_t* camera, const thimble_shading_t* shading,
                                 const thimble_band_t* band);

// --- Worlds that are edited while they are drawn ---------------------------------------------------------

/// The least bytes of a world of that tree: add what digging and building wants, as much again, say. 0 where the handle
/// holds nothing, the tree was coarsened, its level is no brick map's (2 .. 8; 9 and 10 too, with
/// THIMBLE_DEEP_WORLDS), or has more than 65,000 bricks. Cost: one pass.
size_t thimble_world_bytes(const thimble_tree_t* tree);
/// Copies the tree into `bytes`, at a multiple of 8, and shares out what is left as room. THIMBLE_BAD_ARGUMENT: null, not
/// open, coarsened, address; THIMBLE_DAMAGED: the tree; THIMBLE_OUT_OF_MEMORY: size_bytes, more than 32 materials of solid
/// bricks; THIMBLE_OUT_OF_RANGE: level. Cost: some 1,000 instructions a brick.
int32_t thimble_world_make(thimble_world_t* world, const thimble_tree_t* tree, void* bytes,
                           size_t size_bytes);
/// The world's tree and its brick map as they are now, to draw, trace and pick. Fetch both again after each edit; a map
/// and a tree of two times are THIMBLE_DAMAGED, and frames of a tree begin again. THIMBLE_BAD_ARGUMENT: null, not made.
int32_t thimble_world_tree(const thimble_world_t* world, thimble_tree_t* tree);
int32_t thimble_world_bricks(const thimble_world_t* world, thimble_bricks_t* bricks);
/// Makes a voxel solid, of material 0 .. 255, or empty with -1, whatever it was. THIMBLE_BAD_ARGUMENT: null, not made;
/// THIMBLE_OUT_OF_RANGE: outside the world, material; THIMBLE_OUT_OF_MEMORY: no room, which opening a solid block takes,
/// too. Cost: thimble/tree/edited_world.h.
int32_t thimble_world_put(thimble_world_t* world, int32_t x, int32_t y, int32_t z, int32_t material);
/// The voxel's material; -1 where it is empty, outside the world, and where the handle holds nothing.
int32_t thimble_world_material(const thimble_world_t* world, int32_t x, int32_t y, int32_t z);

/// An empty journal of size_bytes / 8 voxels and edits, at any address. THIMBLE_BAD_ARGUMENT: null.
int32_t thimble_journal_make(thimble_journal_t* journal, void* bytes, size_t size_bytes);
enum thimble_edit_shape {
  THIMBLE_EDIT_BOX = 0,  ///< all voxels of the box
  THIMBLE_EDIT_BALL =
      1  ///< those whose centre lies in the ellipsoid that touches its sides, in a cube a ball
};
/// Puts all voxels of a shape as one edit, all or none, and notes it. What lies outside the world is passed over. A journal
/// belongs to one world, between whose edits nothing else changes it. THIMBLE_BAD_ARGUMENT: null, not made, shape;
/// THIMBLE_OUT_OF_RANGE: material, a side of more than 512, a corner beyond +-2^20; THIMBLE_OUT_OF_MEMORY: no room in the
/// world, or in the journal, which takes a voxel for each that changes and one an edit.
int32_t thimble_world_edit(thimble_world_t* world, thimble_journal_t* journal, const thimble_box_t* box,
                           int32_t shape, int32_t material);
/// Takes the journal's last edit back. THIMBLE_BAD_ARGUMENT: null, not made, or no edit is left.
int32_t thimble_world_undo(thimble_world_t* world, thimble_journal_t* journal);
/// Writes the tree as bytes for thimble_tree_open, flash, or a file; `size_written` (may be null) gets how many, also when
/// they do not fit: THIMBLE_OUT_OF_MEMORY. THIMBLE_BAD_ARGUMENT: null, not made. Cost: level + 1 passes.
int32_t thimble_world_pack(const thimble_world_t* world, void* bytes, size_t size_bytes,
                           size_t* size_written);

// --- Frames that stop in time ----------------------------------------------------------------------------

/// Bytes that a frame works in: the picture, rows without gaps, at its front, and a bit a pixel. Each side
/// 1 .. 16384; 0 beyond that and for an unknown format.
size_t thimble_frame_bytes(int32_t format, int32_t width_px, int32_t height_px);
/// Makes a frame, all background. `bytes` are thimble_frame_bytes of the camera's picture; the palette of
/// `shading` outlives the frame. THIMBLE_BAD_ARGUMENT: null, not open or set, another level, format, mode;
/// THIMBLE_OUT_OF_MEMORY: size_bytes. Cost: clears the picture.
int32_t thimble_frame_make(thimble_frame_t* frame, const thimble_tree_t* tree, const thimble_camera_t* camera,
                           const thimble_shading_t* shading, int32_t format, void* bytes, size_t size_bytes);
/// Goes on with so many visits of nodes more, from coarse to fine: the bytes hold a whole picture at all
/// times. What is left over, less than a ray may need, is kept for the next call. THIMBLE_BAD_ARGUMENT:
/// null, not begun, another tree's level.
int32_t thimble_frame_refine(thimble_frame_t* frame, const thimble_tree_t* tree, uint32_t max_visits);
/// Pixels that may still differ from the exact picture, that of thimble_tree_render; 0 when it is done, and
/// where the handle is null or holds nothing.
uint32_t thimble_frame_inexact(const thimble_frame_t* frame);

// --- Particles -------------------------------------------------------------------------------------------

/// How to set up a world of balls in a field of width x height cells, y down the picture.
typedef struct thimble_particle_config {
  int32_t width;             ///< cells, 0 .. 16384
  int32_t height;            ///< cells, 0 .. 16384
  uint32_t capacity;         ///< most balls at a time, 0 .. 2^20
  int32_t least_diameter;    ///< of a random ball, cells, 1 .. most_diameter
  int32_t most_diameter;     ///< of any ball, cells, 1 .. 16
  uint32_t restitution_q16;  ///< 0 (no bounce) .. 65536 (no loss)
  int32_t gravity_x_q16;     ///< cells a step a step, +-2^26
  int32_t gravity_y_q16;
  uint32_t seed;          ///< of random balls
  int32_t substeps_log2;  ///< each step is made in 2^substeps_log2 parts, 0 .. 4
  int32_t subpixel_bits;  ///< positions are kept to 2^-subpixel_bits cells, 1 .. 15
} thimble_particle_config_t;

/// A ball.
typedef struct thimble_particle {
  int32_t id;
  int32_t x_q16;  ///< centre, cells
  int32_t y_q16;
  int32_t vx_q16;  ///< cells a step
  int32_t vy_q16;
  int32_t diameter;  ///< cells
  int32_t corner_x;  ///< the least cell of the square around its disc
  int32_t corner_y;
  int32_t is_asleep;  ///< 1 or 0
} thimble_particle_t;

enum thimble_particle_ids { THIMBLE_NO_PARTICLE = -1 };

/// The paper's world: 800 x 600 cells, 693 balls. Null: nothing.
void thimble_particle_config_default(thimble_particle_config_t* config);
/// Bytes of a world; 0 for null and for a number beyond its limits. 3,604 for 60 balls of up to 8 cells on
/// 128 x 64.
size_t thimble_particles_bytes(const thimble_particle_config_t* config);
/// An empty world in `bytes` (any address). THIMBLE_BAD_ARGUMENT: null; THIMBLE_OUT_OF_RANGE: the
/// configuration; THIMBLE_OUT_OF_MEMORY: size_bytes below thimble_particles_bytes. Cost: clears the bytes.
int32_t thimble_particles_make(thimble_particles_t* world, const thimble_particle_config_t* config,
                               void* bytes, size_t size_bytes);

/// Puts a ball; `id` (may be null) gets its number. THIMBLE_BAD_ARGUMENT: null or not made;
/// THIMBLE_OUT_OF_RANGE: diameter not 1 .. most_diameter, a velocity beyond +-2^29, the disc not all inside
/// the field; THIMBLE_OUT_OF_MEMORY: as many balls as there may be, or something is in the way.
int32_t thimble_particles_add(thimble_particles_t* world, int32_t x_q16, int32_t y_q16, int32_t vx_q16,
                              int32_t vy_q16, int32_t diameter, int32_t* id);
/// Puts a random ball with velocities up to +-max_speed_q16. Errors as above. Cost: up to one look a cell.
int32_t thimble_particles_add_random(thimble_particles_t* world, int32_t max_speed_q16, int32_t* id);
/// Takes a ball away. THIMBLE_BAD_ARGUMENT: null or not made; THIMBLE_OUT_OF_RANGE: there is none.
int32_t thimble_particles_remove(thimble_particles_t* world, int32_t id);
/// Gives a ball a velocity and wakes it. Errors as above; THIMBLE_OUT_OF_RANGE also beyond +-2^29.
int32_t thimble_particles_set_velocity(thimble_particles_t* world, int32_t id, int32_t vx_q16,
                                       int32_t vy_q16);
/// +-2^26 each, else THIMBLE_OUT_OF_RANGE. A change wakes every ball. THIMBLE_BAD_ARGUMENT: null or not made.
int32_t thimble_particles_set_gravity(thimble_particles_t* world, int32_t x_q16, int32_t y_q16);
/// Fills the cells x .. x + width - 1, y .. y + height - 1 with a wall, or clears walls there and wakes
/// what rested on them. Cells of balls, and what lies outside the field, are passed over.
/// THIMBLE_BAD_ARGUMENT: null or not made; THIMBLE_OUT_OF_RANGE: a negative size. Cost: the words of the
/// box and the balls near it.
int32_t thimble_particles_draw_box(thimble_particles_t* world, int32_t x, int32_t y, int32_t width,
                                   int32_t height);
int32_t thimble_particles_erase_box(thimble_particles_t* world, int32_t x, int32_t y, int32_t width,
                                    int32_t height);
/// One step of time. Cost: some 300 instructions for each ball awake, 1,500 more where it meets something;
/// nothing for sleepers. THIMBLE_BAD_ARGUMENT: null or not made.
int32_t thimble_particles_step(thimble_particles_t* world);

typedef struct thimble_particles_info {
  int32_t width;      ///< cells
  int32_t height;     ///< cells
  uint32_t count;     ///< balls there are
  uint32_t asleep;    ///< of these
  uint32_t id_limit;  ///< their numbers are below this; not all need be in use
  uint32_t steps;     ///< made so far
} thimble_particles_info_t;
/// Constant time. THIMBLE_BAD_ARGUMENT: null or not made.
int32_t thimble_particles_get_info(const thimble_particles_t* world, thimble_particles_info_t* info);
/// Ball `id`. THIMBLE_BAD_ARGUMENT: null or not made; THIMBLE_OUT_OF_RANGE: there is none.
int32_t thimble_particles_get(const thimble_particles_t* world, int32_t id, thimble_particle_t* particle);
/// The ball that covers a cell, or THIMBLE_NO_PARTICLE; that also where the handle holds nothing. Constant
/// time.
int32_t thimble_particles_at(const thimble_particles_t* world, int32_t x, int32_t y);
/// Cells x .. x + 31 of row y, the lowest bit on the left, 1 where a ball or a wall is; 0 outside the field
/// and where the handle holds nothing. Any x, any y. Two words are read.
uint32_t thimble_particles_cells(const thimble_particles_t* world, int32_t x, int32_t y);
/// CRC-32 of the whole state, equal on every machine; 0 where the handle holds nothing. A pass over all.
uint32_t thimble_particles_crc32(const thimble_particles_t* world);

#ifdef __cplusplus
}
#endif

#endif
