#include "wide/raster/frame.h"

#include <math.h>

#include "thimble/picture/camera.h"

namespace thimble::wide {
namespace {

// The unit roundoff of a float, times twice the operations of a sum of three products, a subtraction and a
// division.
constexpr double kRounding = 16.0 / (1 << 24);

struct Row {
  double of[4];  // by axis; the last is the constant
  double norm() const { return fabs(of[0]) + fabs(of[1]) + fabs(of[2]); }
};

Row cross(const double (&a)[3], const double (&b)[3]) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0}};
}

double dot(const Row& row, const double (&v)[3]) {
  return row.of[0] * v[0] + row.of[1] * v[1] + row.of[2] * v[2];
}

// |one - p * other|_1, which is how far a box of half side 1 reaches at column (or row) p, times the depth.
double reach(const Row& one, const Row& other, double p) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += fabs(one.of[axis] - p * other.of[axis]);
  }
  return sum;
}
double greatest_reach(const Row& one, const Row& other, double low, double high) {
  return fmax(reach(one, other, low), reach(one, other, high));
}

double rounding_of(const Row& one, const Row& other, double p) {
  return kRounding * (one.norm() + p * other.norm());
}
double across_length(const Row& one, const Row& other) {
  double along = 0;
  double square = 0;
  double other_square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    along += one.of[axis] * other.of[axis];
    square += one.of[axis] * one.of[axis];
    other_square += other.of[axis] * other.of[axis];
  }
  return sqrt(fmax(0, square - along * along / other_square)) * 0.999;
}

void store(const Row& row, float (&to)[4]) {
  for (int i = 0; i < 4; ++i) {
    to[i] = static_cast<float>(row.of[i]);
  }
}

// Splits a 32.32 number into high * 2^20 + low, 0 <= low < 2^20.
void split(int64_t value, double* high, double* low) {
  *high = static_cast<double>(value >> 20);
  *low = static_cast<double>(value & ((1 << 20) - 1));
}

// The camera's map of pixels, in 1/256 voxel.
struct Map {
  double base[3], step_x[3], step_y[3];
};

// Stores the map for exact rays.
Map store_exact(const Camera::Affine& affine, WideFrame* frame) {
  constexpr double kOne = 4294967296.0;  // 2^32
  Map map{};
  for (int axis = 0; axis < 3; ++axis) {
    split(affine.base[axis], &frame->base_high[axis], &frame->base_low[axis]);
    split(affine.step_x[axis], &frame->step_x_high[axis], &frame->step_x_low[axis]);
    split(affine.step_y[axis], &frame->step_y_high[axis], &frame->step_y_low[axis]);
    map.base[axis] = static_cast<double>(affine.base[axis]) / kOne;
    map.step_x[axis] = static_cast<double>(affine.step_x[axis]) / kOne;
    map.step_y[axis] = static_cast<double>(affine.step_y[axis]) / kOne;
  }
  return map;
}

// Stores the map for rays in floats, as whole numbers and fractions.
void store_floats(const Map& map, WideFrame* frame) {
  double whole = 0;
  double rest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double parts[3] = {map.base[axis], map.step_x[axis], map.step_y[axis]};
    const double times[3] = {1, static_cast<double>(frame->tile.x1), static_cast<double>(frame->tile.y1)};
    double whole_sum = 0;
    double rest_sum = 0;
    for (int part = 0; part < 3; ++part) {
      const double nearest = nearbyint(parts[part]);
      frame->map_whole[part][axis] = static_cast<float>(nearest);
      frame->map_rest[part][axis] = static_cast<float>(parts[part] - nearest);
      whole_sum += fabs(nearest) * times[part];
      rest_sum += fabs(parts[part] - nearest) * times[part];
    }
    whole = fmax(whole, whole_sum);
    rest = fmax(rest, rest_sum);
  }
  // Three fractions, products and sums are each rounded by half a unit in the last place of at most `rest`.
  frame->map_error = whole < (1 << 24) ? static_cast<float>(fmin(0.5, rest * 8 / (1 << 24) + 1e-6)) : 0.5F;
}

// The rows of the projection, and for each the greatest sum of magnitudes that goes into it for a point of the world.
struct Projection {
  Row u, v, w;
  double magnitude[3];
};

// Inverts the matrix whose columns are the map's three vectors: base, step_x and step_y for a perspective
// camera, direction, step_x and step_y for an orthographic one, in voxels. Returns false where it has no
// inverse.
bool invert(const Camera& camera, Map map, Projection* to) {
  const bool perspective = camera.is_perspective();
  double along[3];
  double eye[3];
  for (int axis = 0; axis < 3; ++axis) {
    eye[axis] = camera.eye()[axis].raw / 256.0;
    if (perspective) {
      along[axis] = map.base[axis];
    } else {
      along[axis] = camera.direction()[axis];
      eye[axis] += map.base[axis] / 256;
      map.step_x[axis] /= 256;
      map.step_y[axis] /= 256;
    }
  }
  *to = {cross(map.step_y, along), cross(along, map.step_x), cross(map.step_x, map.step_y), {}};
  const double determinant = dot(to->w, along);
  if (!(fabs(determinant) > 0)) {
    return false;
  }
  Row* const rows[3] = {&to->u, &to->v, &to->w};
  for (int r = 0; r < 3; ++r) {
    Row& row = *rows[r];
    for (int axis = 0; axis < 3; ++axis) {
      row.of[axis] /= determinant;
    }
    if (r == 2 && !perspective) {
      row = {{0, 0, 0, 1}};
    } else {
      row.of[3] = -dot(row, eye);
    }
    to->magnitude[r] = row.norm() * (1 << camera.level()) + fabs(row.of[0] * eye[0]) +
                       fabs(row.of[1] * eye[1]) + fabs(row.of[2] * eye[2]) + (perspective ? 0 : 1);
  }
  return true;
}

}  // namespace

bool make_frame(const Camera& camera, const Rectangle& tile, WideFrame* frame) {
  frame->tile = tile;
  frame->camera = &camera;
  for (int axis = 0; axis < 3; ++axis) {
    frame->eye[axis] = camera.eye()[axis].raw;
    frame->direction[axis] = camera.direction()[axis];
    frame->eye_cell[axis] = camera.is_perspective()      ? frame->eye[axis] >> 8
                            : frame->direction[axis] < 0 ? INT32_MAX
                                                         : INT32_MIN;
  }
  frame->perspective = camera.is_perspective();
  const Map map = store_exact(camera.affine(), frame);
  store_floats(map, frame);
  Projection projection;
  if (!invert(camera, map, &projection)) {
    return false;
  }
  const Row& u = projection.u;
  const Row& v = projection.v;
  const Row& w = projection.w;
  const double(&magnitude)[3] = projection.magnitude;
  store(u, frame->u);
  store(v, frame->v);
  store(w, frame->w);

  const double left = tile.x0 - 1.0;
  const double right = tile.x1;
  const double top = tile.y0 - 1.0;
  const double bottom = tile.y1;
  const Row none{};
  const Row& depth = frame->perspective ? w : none;
  const double across = greatest_reach(u, depth, left, right);
  const double down = greatest_reach(v, depth, top, bottom);
  frame->rounding_x = static_cast<float>(kRounding * (magnitude[0] + right * magnitude[2]));
  frame->rounding_y = static_cast<float>(kRounding * (magnitude[1] + bottom * magnitude[2]));
  frame->half_w = static_cast<float>(frame->perspective ? w.norm() * 0.5 * 1.0001 : 0);
  frame->rounding_w = static_cast<float>(kRounding * magnitude[2]);
  // Rays are rounded by up to half a unit of the direction (or 1/512 voxel of the origin).
  const double unit = frame->perspective ? 0.5 : 0.5 / 256;
  const double shrink = frame->perspective ? 1 - unit * w.norm() : 1;
  if (!(shrink > 0.5)) {
    return false;
  }
  // A box's far side is (1 + h |W|_1 / W.c) times as far away as its centre, and rays deviate as much more there.
  const double farther = 1 + (frame->perspective ? unit / shrink * w.norm() : 0);
  frame->reach_x = static_cast<float>(across * 0.5 * 1.0001 * farther);
  frame->reach_y = static_cast<float>(down * 0.5 * 1.0001 * farther);
  frame->slack_x = static_cast<float>(across * unit / shrink + kRounding * right + 1e-4);
  frame->slack_y = static_cast<float>(down * unit / shrink + kRounding * bottom + 1e-4);
  frame->spread_x = static_cast<float>(kRounding * right + 1e-4);
  frame->spread_y = static_cast<float>(kRounding * bottom + 1e-4);
  frame->per_direction = static_cast<float>(0.5 / shrink * 1.0001);
  // |U - column W|_1 is at least the length of U's part across W. Floats keep it within a two-thousandth only if that
  // length is so much larger than their error.
  const bool is_sound = frame->perspective && rounding_of(u, w, right) < 5e-4 * across_length(u, w) &&
                        rounding_of(v, w, bottom) < 5e-4 * across_length(v, w);
  frame->norm_w = is_sound ? static_cast<float>(w.norm() * 1.0001) : 1e30F;
  return frame->slack_x < 4 && frame->slack_y < 4 && frame->rounding_x < 16 * frame->reach_x &&
         frame->rounding_y < 16 * frame->reach_y;
}

}  // namespace thimble::wide
