/* The C face of the library of files, in C99: loads a scene, and says what is wrong with one that is none. */
#include "thimble/files_c.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(const char* what) {
  fprintf(stderr, "files.c: %s\n", what);
  return 1;
}

int main(int count, char** words) {
  char error[40] = "";
  uint32_t side = 0;
  uint8_t rgb[768];
  uint64_t i, voxels;
  ThimbleFile* file = thimble_file_open("no/such.vox", 0, error, sizeof error);
  if (file != NULL || strlen(error) == 0 || strlen(error) >= sizeof error) return fail("a missing file is no error");
  if (thimble_file_open("no/such.vox", 0, NULL, 0) != NULL) return fail("a missing file opens");
  thimble_file_close(NULL);
  file = thimble_file_open(count > 1 ? words[1] : "castle", 0, error, sizeof error);
  if (file == NULL) return fail(error);
  voxels = thimble_file_size(file, &side);
  if (voxels == 0 || side < 2 || side > 4096 || thimble_file_size(file, NULL) != voxels) return fail("a wrong size");
  ThimbleFileVoxel* all = malloc((size_t)voxels * sizeof *all);
  if (all == NULL || thimble_file_voxels(file, all, voxels + 1) != voxels) return fail("not all voxels");
  if (thimble_file_voxels(file, all, 3) != 3) return fail("more voxels than there is room for");
  for (i = 0; i < voxels; ++i) {
    if (all[i].x >= side || all[i].y >= side || all[i].z >= side || all[i].unused != 0) return fail("a voxel outside");
  }
  thimble_file_palette(file, rgb);
  printf("%lu voxels in a world of %lu, the first at %u,%u,%u in %02x%02x%02x\n", (unsigned long)voxels,
         (unsigned long)side, all[0].x, all[0].y, all[0].z, rgb[3 * all[0].material], rgb[3 * all[0].material + 1],
         rgb[3 * all[0].material + 2]);
  free(all);
  thimble_file_close(file);
  return 0;
}
