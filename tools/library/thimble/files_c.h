/* Voxels of a file for C and all that calls C: libthimble_files, five functions. C99.
 *
 *     char error[200];
 *     ThimbleFile* file = thimble_file_open("castle.vox", 0, error, sizeof error);
 *     if (file == NULL) puts(error);
 *
 * What is read, and how, is what the thimble command reads: thimble/files.h. World axes are right-handed, z up. */
#ifndef THIMBLE_FILES_C_H
#define THIMBLE_FILES_C_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ThimbleFile ThimbleFile;

/* A solid voxel: where, and its row in the palette. 8 bytes. */
typedef struct ThimbleFileVoxel {
  uint16_t x, y, z;
  uint8_t material;
  uint8_t unused; /* 0 */
} ThimbleFileVoxel;

/* Reads the file, or scene, `path`, in UTF-8. `depth`: the world is 2^depth voxels a side, 1 to 12; 0: as the format has
 * it. Returns NULL for what cannot be read; `error` (may be NULL) then gets a sentence of at most `error_bytes` - 1 bytes,
 * ended by 0. */
ThimbleFile* thimble_file_open(const char* path, int depth, char* error, size_t error_bytes);

/* How many voxels are solid. `side` (may be NULL) gets the world's side in voxels. */
uint64_t thimble_file_size(const ThimbleFile* file, uint32_t* side);

/* Copies the first `count` of them, in Morton order, and returns how many that were: all, where there is room for all. */
uint64_t thimble_file_voxels(const ThimbleFile* file, ThimbleFileVoxel* voxels, uint64_t count);

/* The 256 colours: red, green, blue, a byte each. */
void thimble_file_palette(const ThimbleFile* file, uint8_t rgb[768]);

/* Frees it; NULL may be given. */
void thimble_file_close(ThimbleFile* file);

#ifdef __cplusplus
}
#endif

#endif
