/// @file xyz.h
/// `.xyz` and `.csv` point clouds: one point a line.
///
/// Columns are separated by blanks and tabs, by commas or by semicolons (with or without blanks around
/// them): one of the three for the whole file, decided by the first line of points or by the header that
/// names x, y and z. Two commas or semicolons in a row are an empty column; one at the end of a line is an
/// empty column or nothing. All lines have the same number of columns. Blank lines are skipped, and so is
/// everything from # to the end of a line. A byte order mark is skipped.
///
/// Numbers have a decimal point, never a decimal comma. A line that could be read either way, such as
/// "1,5, 2,5, 3,5", is an error; "1,5,2,5,3,5" is six columns.
///
/// In order, each optional:
/// 1. A first line that is a single whole number announces the number of points (as in chemistry's files and
///    `.pts`); it must then be right, which finds files that were cut off.
/// 2. A line whose first column is not a number is a header, once, before all points. Columns named x, y, z
///    (any case, quotes allowed, a leading // allowed) are the coordinates; without these three names they
///    are the first three columns of what follows. Columns named r, g, b or red, green, blue are the colour.
/// 3. Points. Columns that mean nothing are not read, whatever they hold.
///
/// Colour without a header: columns 4 to 6, of 7 and 9 columns the last three, when in the whole file all are from 0
/// to 1, or whole numbers up to 255. Otherwise they are normals or something else and ignored. A header that names no
/// colour says that there is none.
/// Colour by a header: 0 to 1 where no value of the file is above 1, else 0 to 255, or to 65535 when one is above 255.
///
/// A count, a comment and lines that begin with an element's symbol are a molecule: its atoms are points.
/// Points that are not finite are left out.
#ifndef THIMBLE_TOOLS_READERS_XYZ_H
#define THIMBLE_TOOLS_READERS_XYZ_H

#include "readers/shared_bytes.h"
#include "readers/source.h"

namespace thimble::tools {

/// Checks the whole file once; the result keeps `file` and parses it anew for each `for_each`, so that no
/// memory depends on the number of points. `CloudPoint::line` is the line in the file.
/// @throws InputError  naming the line: a column that is missing, empty or no number, a colour out of
///   range, a number of columns that differs; an announced number of points that
///   is wrong; no point that is finite
Source read_xyz(const SharedBytes& file, const Progress& progress = {});

}  // namespace thimble::tools

#endif
